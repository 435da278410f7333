// Pictures on canvases: a map, a section, curves.

const INK = "#1c2430", PALE = "#c6ccd5", BLUE = "#1c4f82", ORANGE = "#c5620c", FILL = "#ded6c8";
// viridis at five places
const STOPS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

export function color(share) {
  const at = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1);
  const k = Math.min(Math.floor(at), STOPS.length - 2);
  return STOPS[k].map((low, c) => Math.round(low + (at - k) * (STOPS[k + 1][c] - low)));
}

// a canvas as sharp as the screen, empty
function cleared(canvas) {
  const width = canvas.clientWidth, height = Math.round(width * Number(canvas.dataset.shape));
  const ratio = devicePixelRatio || 1;
  Object.assign(canvas, { width: width * ratio, height: height * ratio });
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  context.font = "11px system-ui, sans-serif";
  context.lineWidth = 1;
  return { context, width, height };
}

function ticks(low, high) {
  const raw = (high - low) / 4, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
  const all = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) all.push(Number((k * step).toPrecision(6)));
  return all;
}

// a frame with ticks; the maps from values to places and back
function axes(canvas, [left, right, bottom, top], [xLabel, yLabel], margins = [46, 14, 20, 30]) {
  const { context, width, height } = cleared(canvas);
  const [l, r, t, b] = margins;
  const x = (value) => l + ((value - left) / (right - left)) * (width - l - r);
  const y = (value) => height - b - ((value - bottom) / (top - bottom)) * (height - t - b);
  const inverse = (px, py) => [left + ((px - l) / (width - l - r)) * (right - left), bottom + ((height - b - py) / (height - t - b)) * (top - bottom)];
  context.strokeStyle = PALE;
  context.fillStyle = INK;
  context.strokeRect(l, t, width - l - r, height - t - b);
  if (xLabel) for (const value of ticks(left, right)) label(context, String(value), x(value), height - b + 12, "center");
  for (const value of ticks(bottom, top)) label(context, String(value), l - 4, y(value) + 4, "right");
  label(context, xLabel, l + (width - l - r) / 2, height - 4, "center");
  label(context, yLabel, 4, 11, "left");
  return { context, width, height, x, y, inverse, range: [left, right, bottom, top], margins };
}

function label(context, text, x, y, align) {
  context.textAlign = align;
  context.fillText(text, x, y);
}

function path(context, points, stroke) {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.strokeStyle = stroke;
  context.stroke();
}

// pressures of square cells, x1 to the right, with their scale
export function map(canvas, field, { cells, side, peak }) {
  const half = side / 2, bar = 62;
  const shape = Number(canvas.dataset.shape), width = canvas.clientWidth;
  const edge = Math.min(width - 46 - bar, width * shape - 50);
  const area = axes(canvas, [-half, half, -half, half], ["x1 [mm]", "x2 [mm]"], [46, width - 46 - edge, 20, width * shape - 20 - edge]);
  if (!field.length || !peak) return;
  const image = new ImageData(cells, cells);
  for (let i = 0; i < cells; i++) {
    for (let j = 0; j < cells; j++) {
      const pressure = field[i * cells + j], at = 4 * ((cells - 1 - j) * cells + i);
      image.data.set(pressure > 0 ? [...color(pressure / peak), 255] : [255, 255, 255, 255], at);
    }
  }
  const small = Object.assign(document.createElement("canvas"), { width: cells, height: cells });
  small.getContext("2d").putImageData(image, 0, 0);
  const { context } = area;
  context.imageSmoothingEnabled = false;
  context.drawImage(small, 46, 20, edge, edge);
  const at = 46 + edge + 10;
  for (let k = 0; k < edge; k++) {
    context.fillStyle = `rgb(${color(1 - k / edge)})`;
    context.fillRect(at, 20 + k, 12, 1.5);
  }
  context.fillStyle = INK;
  for (const value of ticks(0, peak / 1e6)) label(context, String(value), at + 15, 20 + edge * (1 - value / (peak / 1e6)) + 4, "left");
  label(context, "MPa", at - 2, 11, "left");
}

// above the pressure along x1, below it both surfaces
export function section(canvas, { pressure, displacement, gap, cells, side, peak }) {
  const half = side / 2;
  const height = canvas.clientWidth * Number(canvas.dataset.shape);
  const top = Math.max(peak / 1e6, 1e-9) * 1.1;
  const upper = axes(canvas, [-half, half, 0, top], ["", "MPa"], [46, 14, 20, height * 0.5]);
  if (!cells || !pressure.length) return;
  const place = (k) => -half + ((k + 0.5) * side) / cells;
  path(upper.context, Array.from(pressure, (p, k) => [upper.x(place(k)), upper.y(p / 1e6)]), BLUE);
  const { context } = upper;
  const surface = Array.from(displacement, (u) => -u * 1e6);
  const indenter = Array.from(gap, (h, k) => surface[k] + h * 1e6);
  const low = Math.min(...surface), tall = Math.max(-low, 1e-3);
  const y = (value) => height - 30 - ((value - low * 1.4) / (tall * 1.9)) * (height * 0.5 - 46);
  const box = [46, height * 0.5 + 8, canvas.clientWidth - 60, height * 0.5 - 38];
  context.save();
  context.beginPath();
  context.rect(...box);
  context.clip();
  context.beginPath();
  context.moveTo(upper.x(place(0)), height);
  surface.forEach((value, k) => context.lineTo(upper.x(place(k)), y(value)));
  context.lineTo(upper.x(place(cells - 1)), height);
  context.fillStyle = FILL;
  context.fill();
  const rigid = indenter.map((value, k) => [upper.x(place(k)), y(value)]).filter(([, value]) => Number.isFinite(value));
  path(context, rigid, ORANGE);
  context.restore();
  context.strokeStyle = PALE;
  context.strokeRect(...box);
  context.fillStyle = INK;
  // those beside the unit are left out
  for (const value of ticks(low * 1.4, tall * 0.5)) if (y(value) > box[1] + 16) label(context, String(value), 42, y(value) + 4, "right");
  label(context, "µm", 4, height * 0.5 + 18, "left");
  for (const value of ticks(-half, half)) label(context, String(value), upper.x(value), height - 18, "center");
  label(context, "x1 [mm]", upper.x(0), height - 4, "center");
}

// one curve; a ring marks the frame that is shown
export function curves(canvas, { x, y, labels, mark, range, note = "", dots = false }) {
  const least = (of, from) => of.reduce((a, b) => Math.min(a, b), from), most = (of, from) => of.reduce((a, b) => Math.max(a, b), from);
  const found = [least(x, 0), most(x, 1e-12), least(y, 0), most(y, 1e-12)];
  const room = 0.06 * (found[3] - found[2]);
  const area = axes(canvas, range ?? [found[0], found[1], found[2] < 0 ? found[2] - room : 0, found[3] + room], labels);
  const points = Array.from(x, (value, k) => [area.x(value), area.y(y[k])]);
  if (points.length) path(area.context, points, BLUE);
  area.context.fillStyle = ORANGE;
  const ring = (point, radius) => (area.context.beginPath(), area.context.arc(...point, radius, 0, 7), area.context.fill());
  if (dots) points.slice(0, -1).forEach((point) => ring(point, 2.5));
  if (points[mark]) ring(points[mark], 3.5);
  area.context.fillStyle = "#68717e";
  if (note) label(area.context, note, area.width / 2 + 18, area.height / 2, "center");
  return area;
}
