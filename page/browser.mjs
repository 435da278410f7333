// The page in a real browser, without a window: its scenes against the values of the native crate, a load drawn by mouse,
// links, and pictures of what is seen. Needs Node and Chromium, nothing else.
//
//     node page/browser.mjs VALUES.json MODULE.wasm FOLDER [BROWSER]

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import fs from "node:fs";
import http from "node:http";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const [values, module, output, browser = "chromium"] = process.argv.slice(2);
// of forces, depths and the loop; areas and pressures hold fewer digits: rounding, whose order the processors choose, decides
// on which cells at the edge a step ends
const TOLERANCE = 1e-11, AT_THE_EDGE = 1e-9;
const home = path.dirname(fileURLToPath(import.meta.url));
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm" };

// ---- a server of this folder and the module, on this machine alone
const server = http.createServer((request, answer) => {
  const name = path.basename(new URL(request.url, "http://localhost").pathname) || "index.html";
  const file = name.endsWith(".wasm") ? module : path.join(home, name);
  if (!fs.existsSync(file)) return answer.writeHead(404).end();
  answer.writeHead(200, { "Content-Type": TYPES[path.extname(file)] ?? "text/plain" }).end(fs.readFileSync(file));
});
await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
const address = `http://127.0.0.1:${server.address().port}/`;

// ---- the browser, spoken to through its pipe: messages of the DevTools protocol end with a zero byte
const profile = fs.mkdtempSync(path.join(os.tmpdir(), "page-"));
const flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-pipe", `--user-data-dir=${profile}`, "--window-size=1280,1100"];
const chromium = spawn(browser, [...flags, "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
const waiting = new Map();
const complaints = [];
let buffer = "", count = 0;
chromium.stdio[4].on("data", (data) => {
  const parts = (buffer + data).split("\0");
  buffer = parts.pop();
  for (const message of parts.map((part) => JSON.parse(part))) {
    if (message.id) {
      const [resolve, reject] = waiting.get(message.id);
      message.error ? reject(new Error(message.error.message)) : resolve(message.result);
    } else if (message.method === "Runtime.exceptionThrown") complaints.push(message.params.exceptionDetails.exception?.description);
  }
});
chromium.on("error", (error) => { throw error; });
let session;
function send(method, params = {}) {
  const id = ++count;
  chromium.stdio[3].write(JSON.stringify({ id, method, params, sessionId: session }) + "\0");
  return new Promise((resolve, reject) => waiting.set(id, [resolve, reject]));
}

async function evaluate(expression) {
  const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
  return result.value;
}

async function until(expression, seconds = 120) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await new Promise((later) => setTimeout(later, 30))) {
    if (await evaluate(expression).catch(() => false)) return;
  }
  assert.fail(`waited ${seconds} s for ${expression}; the page says: ${complaints}`);
}

// a page anew, until its run has ended
async function open(link) {
  await send("Page.navigate", { url: "about:blank" });
  await send("Page.navigate", { url: address + "#" + link });
  await until("window.viscocontact?.done");
  return evaluate("viscocontact.seen()");
}

async function picture(name) {
  const { data } = await send("Page.captureScreenshot", { format: "png", captureBeyondViewport: true });
  fs.writeFileSync(path.join(output, name.toLowerCase().replaceAll(" ", "_") + ".png"), Buffer.from(data, "base64"));
}

function assertClose(seen, expected, what, tolerance = TOLERANCE) {
  assert.equal(seen.length, expected.length, what);
  const scale = Math.max(...expected.map(Math.abs), Number.MIN_VALUE);
  const error = expected.reduce((most, value, k) => Math.max(most, Math.abs(value - seen[k]) / scale), 0);
  assert.ok(error <= tolerance, `${what}: ${error}`);
  return error;
}

async function scenes() {
  for (const expected of JSON.parse(fs.readFileSync(values, "utf8"))) {
    const seen = await open(expected.link);
    assert.equal(seen.refused, expected.refused, expected.name);
    const errors = expected.series.map((series, k) => assertClose(seen.series[k], series, `${expected.name}, series ${k}`, k < 3 ? TOLERANCE : AT_THE_EDGE));
    const cells = assertClose(seen.line, expected.line, `${expected.name}, profile`, AT_THE_EDGE);
    errors.push(...expected.loop.map((line, k) => assertClose(seen.loop[k], line, `${expected.name}, loop ${k}`)));
    const [, force, depth, area, peak, ...loop] = errors.map((error) => error.toExponential(1));
    console.log(`${expected.name}: from native force ${force}, depth ${depth}, area ${area}, peak ${peak}, profile ${cells.toExponential(1)}, loop ${loop}; first step after ${seen.first.toFixed(0)} ms, all ${seen.series[0].length} after ${seen.all.toFixed(0)} ms`);
    await picture(expected.name);
  }
}

// down, up and down again in the canvas of the load
async function drawsALoad() {
  const before = await open("material=Zener&cells=32&steps=20&load=0:1");
  const { x, y, width, height } = await evaluate("(({x, y, width, height}) => ({x, y, width, height}))(document.getElementById('load').getBoundingClientRect())");
  const mouse = (type, across, up) => send("Input.dispatchMouseEvent", { type, button: "left", buttons: 1, clickCount: 1, x: x + width * across, y: y + height * (1 - up) });
  await mouse("mousePressed", 0.15, 0.2);
  for (let k = 1; k <= 40; k++) await mouse("mouseMoved", 0.15 + 0.02 * k, 0.2 + 0.6 * Math.min(k, 40 - k) / 20);
  await mouse("mouseReleased", 0.95, 0.2);
  await until("viscocontact.done");
  const [seen, link] = [await evaluate("viscocontact.seen()"), await evaluate("location.hash.slice(1)")];
  assert.notDeepEqual(seen.series[1], before.series[1], "the load is another");
  assert.ok(link.split("load=")[1].split(",").length >= 3, link);
  assert.ok(Math.max(...seen.series[1]) > 1.5 * seen.series[1].at(-1), "the load rises and falls");
  await picture("drawn");
  // the link keeps it
  assert.deepEqual((await open(link)).series, seen.series, "a link gives the same run");
}

// a number changed in the form, and settings that are refused
async function form() {
  await open("cells=32&steps=10&load=0:1");
  await evaluate("(() => { const input = document.getElementById('set-radius'); input.value = 20; input.dispatchEvent(new Event('change')); })()");
  await until("viscocontact.done");
  assert.equal(await evaluate("location.hash"), "#radius=20&cells=32&steps=10&load=0:1");
  for (const [link, says] of [["cells=1000&load=0:1", "cells along a side: 1000"], ["colour=1", "colour"], ["material=Maxwel&load=0:1", "material"], ["load=0:1,x:2", "NaN"]]) {
    assert.ok((await open(link)).refused.includes(says), `${link}: ${(await open(link)).refused}`);
  }
  // and another scene after them
  assert.equal((await open("cells=32&steps=10&load=0:1")).refused, "");
}

try {
  fs.mkdirSync(output, { recursive: true });
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  ({ sessionId: session } = await send("Target.attachToTarget", { targetId, flatten: true }));
  await send("Page.enable");
  await send("Runtime.enable");
  await scenes();
  await drawsALoad();
  await form();
  assert.deepEqual(complaints, [], "no errors in the page");
  console.log(`the page agrees with the native crate; pictures are in ${output}`);
} finally {
  chromium.kill();
  server.close();
  await new Promise((ended) => chromium.exitCode === null ? chromium.on("exit", ended) : ended());
  fs.rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
}
