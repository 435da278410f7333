// The page: settings go into the module, numbers come out and are drawn. Nothing is computed here but pictures.

import { curves, map, section } from "./draw.js";

// beside the page where it is hosted, in the folder of the build where it is served from the repository
const PLACES = ["viscocontact_page.wasm", "../target/wasm32-unknown-unknown/page/viscocontact_page.wasm"];
const BUDGET_MS = 12;
const element = (id) => document.getElementById(id);

const wasm = await loaded();
wasm.describe();
const { parameters, scenes } = JSON.parse(text());
const values = new Map(parameters.map(({ key, default: value }) => [key, value]));
let load = [[0, 1]];
// what the browser's test reads
const state = (window.viscocontact = { done: false, refused: "", first: 0, all: 0, started: 0, seen });

function seen() {
  const { refused, first, all } = state, count = wasm.frames();
  const line = count ? [...numbers(wasm.line(count - 1, 0), values.get("cells"))] : [];
  const loop = [0, 1].map((of) => [...numbers(wasm.friction_loop(of), wasm.loop_points())]);
  return { refused, first, all, series: [0, 1, 2, 3, 4].map((of) => [...series(of)]), line, loop };
}

async function loaded() {
  for (const place of PLACES) {
    const answer = await fetch(place).catch(() => ({ ok: false }));
    if (answer.ok) return (await WebAssembly.instantiate(await answer.arrayBuffer(), {})).instance.exports;
  }
  element("refused").textContent = "The module is not built: page/README.md has the commands.";
  throw new Error("no module");
}

function text() {
  return new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, wasm.text(), wasm.text_length()));
}

// memory moves when it grows: numbers are read anew each time
function numbers(at, length) {
  return new Float64Array(wasm.memory.buffer, at, length);
}

const series = (of) => numbers(wasm.series(of), wasm.frames());

// ---- settings, the form and the address

function fragment() {
  const parts = [];
  for (const { key, default: value, choices } of parameters) {
    const now = values.get(key);
    if (now !== value) parts.push(`${key}=${choices.length ? choices[now].replaceAll(" ", "-") : now}`);
  }
  return [...parts, "load=" + load.map((point) => point.join(":")).join(",")].join("&");
}

function readFragment(text) {
  for (const { key, default: value } of parameters) values.set(key, value);
  load = [[0, 1]];
  for (const part of text.split("&").filter(Boolean)) {
    const [key, value] = part.split("=");
    const parameter = parameters.find((parameter) => parameter.key === key);
    if (key === "load") load = value.split(",").map((point) => point.split(":").map(Number));
    else if (!parameter) return `the address has a setting that does not exist: ${key}`;
    else if (!parameter.choices.length) values.set(key, Number(value));
    else values.set(key, parameter.choices.findIndex((choice) => choice.replaceAll(" ", "-") === value));
  }
  return "";
}

function makeForm() {
  for (const { key, label, unit, low, high, choices } of parameters) {
    const row = document.createElement("label");
    const input = document.createElement(choices.length ? "select" : "input");
    choices.forEach((choice, k) => input.add(new Option(choice, k)));
    if (!choices.length) Object.assign(input, { type: "number", step: "any", min: low, max: high });
    input.id = "set-" + key;
    input.addEventListener("change", () => {
      values.set(key, Number(input.value));
      changed();
    });
    row.append(label, input, unit);
    element("form").append(row);
  }
  for (const { name, link } of scenes) {
    const anchor = Object.assign(document.createElement("a"), { href: "#" + link, textContent: name });
    element("scenes").append(anchor);
  }
}

// settings that the others leave without effect are not shown
function showForm() {
  const [shape, material, friction] = ["shape", "material", "friction"].map((key) => values.get(key));
  const unused = { radius: shape === 1, slope: shape !== 1, roughness: shape !== 0, seed: shape !== 0 || !values.get("roughness"),
    retarded: material !== 1 && material !== 2, time: material === 3, exponent: material !== 2, amplitude: !friction, period: !friction };
  for (const { key } of parameters) {
    element("set-" + key).value = values.get(key);
    element("set-" + key).parentElement.hidden = unused[key] ?? false;
  }
  for (const anchor of element("scenes").children) anchor.classList.toggle("on", anchor.getAttribute("href") === location.hash);
  const scene = scenes.find(({ link }) => "#" + link === location.hash);
  if (scene) element("about").textContent = scene.text;
}

function changed() {
  history.replaceState(null, "", "#" + fragment());
  showForm();
  begin();
}

// ---- the run

function begin(refused = "") {
  Object.assign(state, { done: false, refused, started: performance.now(), first: 0 });
  parameters.forEach(({ key }, place) => wasm.set(place, values.get(key)));
  wasm.clear_load();
  for (const [time, value] of load) wasm.add_load(time, value);
  const run = (state.run = {});
  const outcome = refused ? -1 : wasm.start();
  if (outcome < 0) return end(refused || text());
  requestAnimationFrame(() => proceed(run));
}

function proceed(run) {
  if (state.run !== run) return;
  const until = performance.now() + BUDGET_MS;
  let outcome = 1;
  while (outcome === 1 && performance.now() < until) {
    outcome = wasm.advance();
    state.first ||= performance.now() - state.started;
  }
  if (outcome < 1) return end(outcome < 0 ? text() : "");
  showLast();
  requestAnimationFrame(() => proceed(run));
}

function end(refused) {
  showLast();
  Object.assign(state, { done: true, refused, all: performance.now() - state.started });
  element("refused").textContent = refused;
}

function showLast() {
  element("refused").textContent = "";
  const last = Math.max(0, wasm.frames() - 1);
  Object.assign(element("frame"), { max: last, value: last });
  wasm.report();
  element("report").textContent = text();
  show();
}

// ---- pictures

function show() {
  const count = wasm.frames();
  const frame = Number(element("frame").value);
  const cells = values.get("cells"), side = values.get("side");
  const [times, forces, depths, areas, peaks] = [0, 1, 2, 3, 4].map(series);
  const line = (of) => (count ? numbers(wasm.line(frame, of), cells) : []);
  const peak = count ? peaks.reduce((a, b) => Math.max(a, b), 0) : 0;
  map(element("map"), count ? numbers(wasm.pressure(frame), cells * cells) : [], { cells, side, peak });
  section(element("profile"), { pressure: line(0), displacement: line(1), gap: line(2), cells, side, peak });
  element("now").textContent = count ? `Time ${times[frame].toPrecision(4)} s: force ${forces[frame].toPrecision(4)} N, depth ` +
    `${(depths[frame] * 1e6).toPrecision(4)} µm, area ${(areas[frame] * 1e6).toPrecision(4)} mm², maximum pressure ${(peaks[frame] / 1e6).toPrecision(3)} MPa` : "Time";
  const over = (of, factor, unit) => ({ x: times, y: of.map((value) => value * factor), labels: ["time [s]", unit], mark: frame });
  curves(element("area"), over(areas, 1e6, "mm²"));
  curves(element("force"), over(forces, 1, "N"));
  curves(element("depth"), over(depths, 1e6, "µm"));
  showLoop();
  showLoad();
}

function showLoop() {
  const points = wasm.loop_points();
  const [x, y] = [0, 1].map((of) => numbers(wasm.friction_loop(of), points));
  const note = points ? "" : values.get("friction") > 0 ? "comes at the end of the run" : "set a friction coefficient";
  curves(element("loop"), { x: x.map((d) => d * 1e6), y, labels: ["displacement along the surface [µm]", "N"], range: points ? undefined : [-1, 1, -1, 1], note });
}

// the axes of the load stay while it is drawn
let axes;

function showLoad() {
  const duration = values.get("duration");
  const held = [...load, [Math.max(duration, load.at(-1)[0]), load.at(-1)[1]]];
  const top = Math.max(...load.map(([, value]) => value), 1e-9) * 1.25;
  axes = curves(element("load"), { x: held.map(([time]) => time), y: held.map(([, value]) => value),
    labels: ["time [s]", values.get("control") === 1 ? "depth [µm]" : "force [N]"], range: stroke?.range ?? [0, duration, 0, top], dots: true });
}

// ---- the load, drawn

let stroke;

function point(event) {
  const box = element("load").getBoundingClientRect();
  const [time, value] = axes.inverse(event.clientX - box.left, event.clientY - box.top);
  const [, end, , top] = axes.range;
  return [Math.min(Math.max(time, 0), end), Math.min(Math.max(value, 0), top)];
}

element("load").addEventListener("pointerdown", (event) => {
  element("load").setPointerCapture(event.pointerId);
  stroke = { range: axes.range, before: load, points: [point(event)] };
});

element("load").addEventListener("pointermove", (event) => {
  if (!stroke) return;
  stroke.points.push(point(event));
  load = joined(stroke.before, stroke.points);
  showLoad();
});

element("load").addEventListener("pointerup", () => {
  if (!stroke) return;
  load = simplified(joined(stroke.before, stroke.points), stroke.range).map((point) => point.map((value) => Number(value.toPrecision(3))));
  stroke = undefined;
  changed();
});

// what was there before and after the stroke stays
function joined(before, points) {
  const sorted = [...points].sort(([a], [b]) => a - b).filter(([time], k, all) => !k || time > all[k - 1][0]);
  const [first, last] = [sorted[0][0], sorted.at(-1)[0]];
  const all = [...before.filter(([time]) => time < first), ...sorted, ...before.filter(([time]) => time > last)];
  return all[0][0] > 0 ? [[0, before[0][1]], ...all] : all;
}

// without the points that lie on the line through their neighbours, to 1 % of the axes (Douglas and Peucker)
function simplified(points, [, end, , top]) {
  const [a, b] = [points[0], points.at(-1)];
  let [farthest, at] = [0.01, -1];
  points.slice(1, -1).forEach(([time, value], k) => {
    const line = a[1] + ((b[1] - a[1]) * (time - a[0])) / (b[0] - a[0]);
    const off = Math.abs(value - line) / top;
    if (off > farthest) [farthest, at] = [off, k + 1];
  });
  if (at < 0) return [a, b];
  return [...simplified(points.slice(0, at + 1), [0, end, 0, top]).slice(0, -1), ...simplified(points.slice(at), [0, end, 0, top])];
}

makeForm();
const fromAddress = () => {
  const refused = readFragment(decodeURIComponent(location.hash.slice(1)) || scenes[0].link);
  showForm();
  begin(refused);
};
addEventListener("hashchange", fromAddress);
addEventListener("resize", show);
element("frame").addEventListener("input", show);
if (!location.hash) history.replaceState(null, "", "#" + scenes[0].link);
fromAddress();
