// SPDX-License-Identifier: BSD-3-Clause
// node check_live.mjs BROWSER SANDRUNNER RECORDING BLACK_BOX: looks at a run while it goes, holds and steps it, loses its server
// and finds it again, drives the robot; then opens both recordings.
import assert from "node:assert/strict";
import { groundAt } from "./file_page.mjs";
import { endServers, launch, serve } from "./served_page.mjs";

const [browserPath, sandrunner, recording, blackBox] = process.argv.slice(2);
const browser = await launch(browserPath);
const errors = [];

async function open(url, viewport = { width: 480, height: 300 }) {  // what a machine without a graphics card can draw
  const page = await browser.newPage();
  await page.setViewport(viewport);
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => {
    // A server that is gone is what this test wants; the browser says so by itself.
    if (message.type() === "error" && !/ERR_CONNECTION_REFUSED|WebSocket connection/.test(message.text())) errors.push(message.text());
  });
  page.on("request", (request) => {
    if (!/^(data|blob):/.test(request.url()) && new URL(request.url()).host !== new URL(url).host) errors.push(request.url());
  });
  await page.goto(`${url}${url.includes("#") ? "&" : "#"}light`);  // as a slow machine draws after some seconds anyway
  await page.waitForFunction("window.sandrunner?.ready_ms", { timeout: 60000 });
  return page;
}
const text = (page, id) => page.$eval(`#${id}`, (element) => element.textContent);
async function until(page, what, timeout = 30000) {
  try {
    await page.waitForFunction(what, { timeout, polling: 50 });
  } catch (error) {
    const shown = await Promise.all(["lost", "mode", "answer", "refusal"].map(async (id) => `${id}: '${await text(page, id)}'`));
    throw new Error(`waited for ${what}; ${shown.join(", ")}, ${await page.evaluate("sandrunner.frames")} frames`, { cause: error });
  }
}
const click = (page, id) => page.$eval(`#${id}`, (element) => element.click());
async function hold(page) {
  await click(page, "hold");
  await until(page, "document.getElementById('hold').textContent === 'go on'");
}

// Runs in the page: nothing else does for 1.5 s; true if it then says, in one of some frames, that the robot is lost.
function lostWhileHeldUp() {
  const end = performance.now() + 1500;
  while (performance.now() < end);
  return new Promise((done) => {
    const look = (frames) => {
      if (document.getElementById("lost").textContent !== "") done(true);
      else if (frames === 0) done(false);
      else requestAnimationFrame(() => look(frames - 1));
    };
    requestAnimationFrame(() => look(5));
  });
}

async function looksAndHolds() {
  const first = await serve(sandrunner, "--set", "view.port=0", "--duration", "600");
  const port = new URL(first.url).port, page = await open(first.url);
  assert.equal(await page.evaluate("location.hash"), "#light", "the key is taken out of the address");
  await until(page, "sandrunner.frames > 150");
  assert.equal(await page.evaluate("sandrunner.kind"), "3d");

  await hold(page);
  const held = await page.evaluate("sandrunner.frames");
  for (let i = 0; i < 3; ++i) await click(page, "policy-step");
  await until(page, `sandrunner.frames > ${held}`);
  assert.ok((await page.evaluate("sandrunner.frames")) <= held + 4, "a step is a step");
  assert.equal(await text(page, "lost"), "", "a robot that is held is not lost");
  assert.equal(await page.evaluate(lostWhileHeldUp), false, "a page that is held up itself has not lost the robot");
  await click(page, "hold");
  await until(page, `sandrunner.frames > ${held + 20}`);

  // Looking back while the robot goes on.
  await page.evaluate("sandrunner.seek(0.5)");
  const before = await page.evaluate("sandrunner.frames");
  await until(page, `sandrunner.frames > ${before + 10}`);
  assert.equal(await page.evaluate("sandrunner.player.t"), 0.5);
  await click(page, "now");

  await page.evaluate("window.sameDocument = true");
  first.child.kill("SIGKILL");
  await until(page, "document.getElementById('lost').textContent !== ''");
  assert.ok(await page.evaluate("sandrunner.frames > 150"), "what was seen stays");
  await serve(sandrunner, "--set", `view.port=${port}`, "--duration", "600");
  await until(page, "document.getElementById('lost').textContent === '' && sandrunner.run.frames.time(0) < 0.1 && sandrunner.frames > 20");
  assert.ok(await page.evaluate("window.sameDocument"), "without a reload");
  await page.close();
}

async function drives() {
  const { url, child } = await serve(sandrunner, "--set", "view.port=0", "--command", "live", "--set", "controller.shaping.operator_stand_s=6");
  const page = await open(url);
  const ask = (name) => page.$eval(`[data-request=${name}]`, (button) => button.click());
  const refused = () => page.$$eval("[aria-disabled=true]", (buttons) => buttons.map((button) => button.dataset.request));
  const mode = (name) => until(page, `document.getElementById('mode').textContent === '${name}'`);
  // Again where the controller was held up for longer than its answer is waited for.
  const bring = async (request, name) => {
    for (let tries = 0; tries < 5; tries++) {
      await page.evaluate("document.getElementById('answer').textContent = ''");
      await ask(request);
      await until(page, `document.getElementById('mode').textContent === '${name}' || /does not answer/.test(document.getElementById('answer').textContent)`);
      if (await page.evaluate(`document.getElementById('mode').textContent === '${name}'`)) return;
    }
    await mode(name);
  };
  await mode("passive");
  assert.deepEqual(await refused(), ["stand", "walk", "lie", "disarm", "reset_fault"]);
  assert.match(await page.$eval("[data-request=walk]", ({ title }) => title), /stand comes first/);
  assert.match(await text(page, "how"), /1 arm, 2 stand, 3 walk/);
  await ask("walk");
  await until(page, "/refused, the robot does not stand|refused, the drives are off/.test(document.getElementById('answer').textContent)");
  await bring("arm", "damping");
  await bring("stand", "stand");
  await bring("walk", "walk");
  await until(page, "/W A S D/.test(document.getElementById('how').textContent)");
  await until(page, "/no command for [0-9]+ s, so it stands: 3 walk goes on/.test(document.getElementById('answer').textContent)");
  await bring("walk", "walk");
  const requested = (vx) => until(page, `sandrunner.run.frames.at(sandrunner.frames - 1, 'requested', 0) === ${vx}`);
  await page.keyboard.down("w");
  await requested(0.5);
  await page.keyboard.up("w");
  await requested(0);
  await page.evaluate(() => {
    const held = Array.from({ length: 8 }, (_, i) => ({ pressed: i === 4 }));
    navigator.getGamepads = () => [{ buttons: held, axes: [0.1, -0.55, 0, 0] }];
  });
  // Half of the speed that is left beyond the dead zone, at half of the full speed; what lies in the dead zone is rest.
  await until(page, "Math.abs(sandrunner.run.frames.at(sandrunner.frames - 1, 'requested', 0) - 0.25) < 1e-3");
  assert.equal(await page.evaluate("sandrunner.run.frames.at(sandrunner.frames - 1, 'requested', 1)"), 0);
  await page.evaluate("navigator.getGamepads = () => []");
  await requested(0);
  await page.keyboard.down("w");
  await requested(0.5);
  // A page that is gone says nothing more: the age of its last word stops the robot.
  await page.close();
  const look = await open(url.split("#")[0]);
  await until(look, "sandrunner.run.frames.at(sandrunner.frames - 1, 'requested', 0) === 0");
  assert.ok(await look.$eval("#drive", (element) => element.hidden), "without the key there is nothing to drive with");
  assert.match(await text(look, "note"), /Watching only: .* with its key/);
  child.kill("SIGINT");
  await look.close();
}

/** A screen reader has a name for each control. */
async function namesItsControls(page) {
  await page.$eval("#ground", (details) => { details.open = true; });
  const kControls = new Set(["button", "combobox", "slider", "spinbutton", "textbox", "checkbox"]), found = [];
  const look = ({ role, name, children = [] }) => {
    if (kControls.has(role)) found.push(`${role} '${name ?? ""}'`);
    children.forEach(look);
  };
  look(await page.accessibility.snapshot());
  assert.ok(found.length > 25, found.join(", "));
  assert.deepEqual(found.filter((control) => control.endsWith("''")), []);
}

async function touches() {
  const { url, child } = await serve(sandrunner, "--set", "view.port=0", "--command", "live", "--record", `${recording}.touched`);
  const page = await open(url, { width: 780, height: 320 });  // a phone on its side, without touch
  const mode = (name) => until(page, `document.getElementById('mode').textContent === '${name}'`);
  const ground = (what) => until(page, `sandrunner.run.live.state.ground.${what}`);
  const last = (field, k) => page.evaluate(`sandrunner.run.frames.at(sandrunner.frames - 1, '${field}', ${k})`);
  await click(page, "on-legs");
  await mode("stand");
  await namesItsControls(page);

  const fill = (name, value) => page.$eval(`[name="${name} as a number"]`, (field, text) => {
    field.value = text;
    field.dispatchEvent(new Event("change"));
  }, value);
  await fill("stiffness", "250000");
  await ground("values.sigma_flat_npm3 === 250000");
  await ground("values.sigma_cone_npm3 === 50000");
  await fill("friction", "9");
  await until(page, "/^page: terrain.friction: .* from 0 to 5$/.test(document.getElementById('refusal').textContent)");
  await ground("values.friction === 0.8");
  await page.select("#preset", "wet-sand");
  await ground("name === 'wet-sand'");
  assert.equal(await text(page, "refusal"), "");

  // Dragged to the right with shift held: pushed. Step by step, and every frame looked at, as the legs stop it within two.
  await hold(page);
  const before = await page.evaluate("sandrunner.frames");
  const fastest = () => page.evaluate((first) => {
    let found = 0;
    for (let i = first; i < sandrunner.frames; ++i) {
      found = Math.max(found, Math.hypot(sandrunner.run.frames.at(i, "motion", 0), sandrunner.run.frames.at(i, "motion", 1)));
    }
    return found;
  }, before);
  const { x, y } = await page.evaluate(() => {
    const free = (x, y) => [x, x + 40].every((at) => document.elementFromPoint(at, y)?.id === "scene");
    for (let y = 0; y < innerHeight; y += 4) for (let x = 0; x < innerWidth; x += 10) if (free(x, y)) return { x, y };
    throw new Error("controls cover the whole scene");
  });
  // 0.5 m/s in the tick of the push, some 0.4 when the next frame is taken.
  const pushed = async () => await fastest() > 0.2;
  assert.ok(!await pushed());
  await page.keyboard.down("Shift");
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 40, y);
  await page.mouse.up();
  await page.keyboard.up("Shift");
  for (let steps = 0; steps < 30 && !await pushed(); ++steps) {
    const seen = await page.evaluate("sandrunner.frames");
    await click(page, "policy-step");
    await until(page, `sandrunner.frames > ${seen}`);
  }
  assert.ok(await pushed(), `the push reaches the robot: ${await fastest()} m/s; ${await text(page, "refusal")}`);
  await click(page, "hold");
  // At once: pushed slowly, it only leans, and lies down.
  await page.$eval("#push", (element) => { for (let i = 0; i < 12; ++i) element.click(); });
  await mode("fault");
  await click(page, "on-legs");
  await mode("stand");
  assert.ok((await last("position_m", 2)) > 0.4);
  child.kill("SIGINT");
  await page.close();
}

async function drivesWithAFinger() {
  const { url, child } = await serve(sandrunner, "--set", "view.port=0", "--command", "live");
  const page = await open(url, { width: 390, height: 600, isMobile: true, hasTouch: true });
  const middle = (id) => page.$eval(`#${id}`, (element) => {
    const { left, top, width, height } = element.getBoundingClientRect();
    return { x: left + width / 2, y: top + height / 2, height };
  });
  await until(page, "document.getElementById('stick').clientHeight > 0");
  const small = await page.$$eval("button, select", (controls) => controls
    .filter((control) => control.offsetParent && control.getBoundingClientRect().height < 44).map(({ id, textContent }) => id || textContent));
  assert.deepEqual(small, [], "a thumb needs 44 px");
  const requested = (k, test) => until(page, `sandrunner.run.frames.at(sandrunner.frames - 1, 'requested', ${k}) ${test}`);
  const stick = await middle("stick"), hold = await middle("stick-hold");
  const finger = await page.touchscreen.touchStart(stick.x, stick.y - 0.45 * stick.height);
  assert.equal(await page.evaluate("sandrunner.run.frames.at(sandrunner.frames - 1, 'requested', 0)"), 0, "a stick alone does nothing");
  const other = await page.touchscreen.touchStart(hold.x, hold.y);
  await requested(0, "> 0.4");
  await other.end();
  await requested(0, "=== 0");
  await finger.end();
  child.kill("SIGINT");
  await page.close();
}

async function opensARecording(file, frames) {
  const { url, child } = await serve(`${sandrunner}-replay`, file, "--set", "view.port=0");
  const page = await open(url);
  assert.ok((await page.evaluate("sandrunner.frames")) > frames);
  const [begin, end] = await page.evaluate("[sandrunner.player.begin, sandrunner.player.end]"), t = (begin + end) / 2;
  const ground = await groundAt(page, t);
  assert.equal(await page.evaluate("sandrunner.player.t"), t);
  assert.notEqual(await groundAt(page, begin), ground);
  await groundAt(page, end);
  assert.equal(await groundAt(page, t), ground, "the same time shows the same ground, wherever one came from");
  child.kill("SIGINT");
  await until(page, "sandrunner.run.live.silent_ms === Infinity");
  assert.equal(await page.evaluate(lostWhileHeldUp), false, "a page has all of its recording, whoever served it");
  await page.close();
  return begin;
}

try {
  await looksAndHolds();
  await drives();
  await touches();
  await drivesWithAFinger();
  assert.equal(await opensARecording(recording, 300), 0);
  await opensARecording(blackBox, 100);
  assert.deepEqual(errors, []);
} finally {
  await browser.close();
  endServers();
}
