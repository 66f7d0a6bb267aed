// SPDX-License-Identifier: BSD-3-Clause
// node check_sandbox.mjs BROWSER PAGE [HIDDEN_S [PICTURES]]: stands, walks, pushes and lifts the robot of a sandbox page, changes
// its ground, compares its bits and hides it for HIDDEN_S seconds; then the same page where no fused multiply-add is.
// PICTURES: folder for pictures of it.
import assert from "node:assert/strict";
import fs from "node:fs";
import puppeteer from "puppeteer-core";
import { kSoftware } from "./file_page.mjs";

const [browserPath, file, hidden_s = "3", pictures] = process.argv.slice(2);
const kMostBytes = 1.3e6;

async function open(flags, look) {
  const args = ["--no-sandbox", ...kSoftware, ...flags];
  const browser = await puppeteer.launch({ executablePath: browserPath, headless: "shell", args, protocolTimeout: 300000 });
  try {
    const page = await browser.newPage();
    await page.setViewport({ width: 480, height: 300 });
    const [errors, requests] = [[], []];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => { if (message.type() === "error") errors.push(message.text()); });
    page.on("request", (request) => { if (!/^(data|blob):/.test(request.url())) requests.push(request.url()); });
    await page.goto(`file://${file}#light`);
    await page.waitForFunction("window.sandrunner?.ready_ms", { timeout: 60000 });
    await look(page);
    assert.deepEqual(errors, []);
    assert.equal(requests.length, 1, "the page asks for nothing but itself");
  } finally {
    await browser.close();
  }
}

const text = (page, id) => page.$eval(`#${id}`, (element) => element.textContent);
async function until(page, what, timeout = 60000) {
  try {
    await page.waitForFunction(what, { timeout, polling: 50 });
  } catch (error) {
    const shown = await Promise.all(["lost", "mode", "answer", "refusal", "clock"].map(async (id) => `${id}: '${await text(page, id)}'`));
    throw new Error(`waited for ${what}; ${shown.join(", ")}`, { cause: error });
  }
}
const mode = (page, name) => until(page, `document.getElementById('mode').textContent === '${name}'`);
const click = (page, id) => page.$eval(`#${id}`, (element) => element.click());
const ask = (page, name) => page.$eval(`[data-request=${name}]`, (button) => button.click());
const last = (page, field, k) => page.evaluate(`sandrunner.run.frames.at(sandrunner.frames - 1, '${field}', ${k})`);
const picture = async (page, name) => { if (pictures) await page.screenshot({ path: `${pictures}/${name}.png` }); };
async function compare(page) {
  await click(page, "compare");
  await until(page, "/equal|DIFFERENT/.test(document.getElementById('compared').textContent)", 200000);
  assert.match(await text(page, "compared"), /^state hash ([0-9a-f]{16}), sandrunner's \1: equal$/);
}

async function drives(page) {
  await mode(page, "passive");
  await ask(page, "walk");
  await until(page, "/refused, the robot does not stand/.test(document.getElementById('answer').textContent)");
  await ask(page, "arm");
  await mode(page, "damping");
  const begin_s = await page.evaluate("sandrunner.run.live.state.t_s");
  await ask(page, "stand");
  await mode(page, "stand");
  assert.ok(await page.evaluate("sandrunner.run.live.state.t_s") - begin_s < 10, "it stands within 10 s");
  await ask(page, "walk");
  await mode(page, "walk");
  const x_m = await last(page, "position_m", 0);
  await page.keyboard.down("w");
  await until(page, `sandrunner.run.frames.at(sandrunner.frames - 1, 'position_m', 0) > ${x_m + 0.5}`);
  await picture(page, "walks");
  await page.keyboard.up("w");
  await until(page, "sandrunner.run.frames.at(sandrunner.frames - 1, 'requested', 0) === 0");
  assert.ok(await page.evaluate("sandrunner.run.footprints.count") > 4, "it leaves footprints");

  await page.select("#preset", "rigid");
  await until(page, "sandrunner.run.live.state.ground.name === 'rigid'");
  const again_m = await last(page, "position_m", 0);
  await page.keyboard.down("w");
  await until(page, `sandrunner.run.frames.at(sandrunner.frames - 1, 'position_m', 0) > ${again_m + 0.3}`);
  await picture(page, "walks-on-hard-ground");
  await page.keyboard.up("w");

  const fill = (name, value) => page.$eval(`[name="${name} as a number"]`, (field, number) => {
    field.value = number;
    field.dispatchEvent(new Event("change"));
  }, value);
  await fill("friction", "9");
  await until(page, "/^page: terrain.friction: found 9, expected 0 to 5$/.test(document.getElementById('refusal').textContent)");
  await fill("friction", "0.5");
  await until(page, "sandrunner.run.live.state.ground.values.friction === 0.5");

  await page.$eval("#push", (element) => { for (let i = 0; i < 12; ++i) element.click(); });
  await mode(page, "fault");
  await picture(page, "falls");
  await click(page, "on-legs");
  await mode(page, "stand");
  assert.ok(await last(page, "position_m", 2) > 0.4);
  await picture(page, "was-lifted");
}

async function holdsAndSteps(page) {
  await click(page, "hold");
  await until(page, "document.getElementById('hold').textContent === 'go on'");
  const held = await page.evaluate("sandrunner.frames");
  for (let i = 0; i < 3; ++i) await click(page, "policy-step");
  await until(page, `sandrunner.frames > ${held}`);
  assert.ok(await page.evaluate("sandrunner.frames") <= held + 4, "a step is a step");
  await click(page, "hold");
  await until(page, `sandrunner.frames > ${held + 20}`);
}

async function stopsWhileHidden(page) {
  // A headless browser hides nothing by itself.
  const hide = (hidden) => page.evaluate((value) => {
    Object.defineProperty(document, "hidden", { value, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"));
  }, hidden);
  const wait = (seconds) => new Promise((done) => setTimeout(done, 1000 * seconds));
  const newest_s = () => page.evaluate("sandrunner.run.frames.time(sandrunner.frames - 1)");
  await hide(true);
  const before_s = await newest_s();
  await wait(Number(hidden_s));
  assert.equal(await newest_s(), before_s, "a hidden page stops");
  const start_ms = performance.now();
  await hide(false);
  await until(page, `sandrunner.run.frames.time(sandrunner.frames - 1) > ${before_s}`);
  await wait(0.5);
  const went_s = await newest_s() - before_s, passed_s = 1e-3 * (performance.now() - start_ms);
  assert.ok(went_s < passed_s + 0.1, `after ${hidden_s} s out of sight it went ${went_s} s in ${passed_s} s`);
}

assert.ok(fs.statSync(file).size <= kMostBytes, `${file} has ${fs.statSync(file).size} bytes, expected at most ${kMostBytes}`);
await open([], async (page) => {
  assert.doesNotMatch(await text(page, "note"), /no fused/);
  await compare(page);
  await drives(page);
  await holdsAndSteps(page);
  await stopsWhileHidden(page);
});
if (process.arch === "x64") {
  await open(["--js-flags=--no-enable-fma3"], async (page) => {
    assert.match(await text(page, "note"), /no fused multiply-add/);
    await compare(page);
  });
}
