// SPDX-License-Identifier: BSD-3-Clause
// node check_page.mjs BROWSER FOLDER: opens FOLDER/run.html from the disk and compares what it shows with
// FOLDER/run.csv. Pictures are judged by their structure, never pixel by pixel.
import assert from "node:assert/strict";
import fs from "node:fs";
import { groundAt, kSoftware, openFile, picture, shares, within } from "./file_page.mjs";

const [browserPath, folder] = process.argv.slice(2);
const kLegs = ["LF", "RF", "LH", "RH"];
const kNoGraphics = ["--disable-gpu", "--disable-software-rasterizer", "--disable-3d-apis"];

const [head, ...lines] = fs.readFileSync(`${folder}/run.csv`, "utf8").trim().split("\n").map((line) => line.split(","));
const column = Object.fromEntries(head.map((name, i) => [name, i]));
const csv = (row, name) => Number(lines[row][column[name]]);

/** Each of 50 moments of the run: the page's feet, by its own kinematics, are where run.csv has them. */
async function checkFeet(page) {
  const rows = Array.from({ length: 50 }, (_, k) => Math.floor(((k * 0.618034) % 1) * (lines.length - 2)));
  const feet = await page.evaluate((times) => times.map((t) => window.sandrunner.feetAt(t)), rows.map((row) => csv(row, "t_s")));
  let worst = 0;
  rows.forEach((row, i) => kLegs.forEach((leg, l) => ["x", "y", "z"].forEach((axis, a) => {
    worst = Math.max(worst, Math.abs(feet[i][l][a] - csv(row, `${leg}_foot_${axis}_m`)));
  })));
  assert.ok(worst < 5e-5, `feet are up to ${worst} m from those of run.csv`);
  return worst;
}

/** A moment of the walk with most feet in the ground. */
function deepMoment() {
  const depth = (row) => Math.min(...["RF", "LH"].map((leg) => csv(row, `${leg}_penetration_m`)));
  const walking = lines.map((_, row) => row).filter((row) => lines[row][column.mode] === "walk" && csv(row, "t_s") > 6);
  return csv(walking.reduce((best, row) => (depth(row) > depth(best) ? row : best)), "t_s");
}

/** Holes are where the simulator's feet were deepest, and darker than the sand around; looking back shows the same. */
async function checkHoles(page, t) {
  const before = await groundAt(page, t);
  for (const ago of [3, 1]) await groundAt(page, t - ago);
  assert.equal(await groundAt(page, t), before, "the same time shows the same ground, wherever one came from");
  const prints = await page.evaluate((time) => {
    const { view, run } = window.sandrunner, found = [];
    for (let i = 0; i < run.footprints.count; ++i) {
      const [at, x, y, depth] = ["t_s", "x_m", "y_m", "depth_m"].map((name) => run.footprints.at(i, name));
      if (at < time) found.push({ depth, shown: view.heights.pressedAt(x, y) });
    }
    return found;
  }, t);
  assert.ok(prints.length >= 12, `${prints.length} footprints`);
  for (const { depth, shown } of prints) assert.ok(shown <= -0.95 * depth, `a footprint of ${depth} m is shown as ${shown} m`);
}

/** Holes that nothing stands in have a part that is much darker than the sand. */
async function checkDarkness(page, t) {
  const at = await page.evaluate((time) => {
    const { view, run, seek } = window.sandrunner, found = [];
    view.overlays.group.visible = false;
    seek(time);
    for (let i = 0; i < run.footprints.count; ++i) {
      const age = time - run.footprints.at(i, "t_s"), [x, y] = ["x_m", "y_m"].map((name) => run.footprints.at(i, name));
      if (age < 0.5 || age > 1) continue;
      const p = view.focus.clone().set(x, y, 0).project(view.camera);
      found.push([(p.x + 1) / 2, (1 - p.y) / 2]);
    }
    return found;
  }, t);
  assert.ok(at.length >= 3, `${at.length} holes`);
  const image = await picture(page, t), brightness = (x, y) => image.at(x, y).reduce((sum, v) => sum + v, 0) / 3;
  const sand = [];
  for (let y = Math.floor(0.8 * image.height); y < image.height; ++y) for (let x = 0; x < image.width; x += 3) sand.push(brightness(x, y));
  const usual = sand.sort((a, b) => a - b)[sand.length >> 1];
  const reach = Math.ceil(0.025 * image.width);
  for (const [u, v] of at) {
    const [x, y] = [Math.round(u * image.width), Math.round(v * image.height)];
    if (x < reach || y < reach || x + reach >= image.width || y + reach >= image.height) continue;
    let darkest = 255;
    for (let j = -reach; j <= reach; ++j) for (let i = -reach; i <= reach; ++i) darkest = Math.min(darkest, brightness(x + i, y + j));
    assert.ok(darkest < 0.7 * usual, `a hole at ${x}, ${y} is no darker than ${darkest}; sand is ${usual}`);
  }
  await page.evaluate(() => { window.sandrunner.view.overlays.group.visible = true; });
}

/** With "whole run", a plot has lines behind the shown time too. */
async function checkWholeRun(page) {
  const inked = () => page.evaluate(() => {
    window.sandrunner.seek(0.1);
    const canvas = document.querySelector("#plots canvas"), { width, height } = canvas;
    const { data } = canvas.getContext("2d").getImageData(width / 2, height / 4, width / 2, height * 0.75);
    return data.reduce((count, red, i) => count + (i % 4 === 0 && data[i + 3] > 0 && Math.abs(red - data[i + 2]) > 60), 0);
  });
  const before = await inked();
  await page.select("#span", "run");
  const after = await inked();
  assert.ok(before < 60 && after > 200, `${before} pixels of a line, then ${after}`);
  await page.select("#span", "last 6 s");
}

/** Text stands out from its ground by 4.5 to 1, on light pages and on dark ones. */
async function checkContrast(page) {
  const light = (color) => color.match(/[0-9a-f]{2}/gi).slice(0, 3).map((hex) => parseInt(hex, 16) / 255)
    .map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + [0.2126, 0.7152, 0.0722][i] * v, 0);
  const kPairs = [["--ink", "--paper"], ["--ink", "--button"], ["--quiet", "--panel"], ["--off-ink", "--off"], ["--note-ink", "--note"],
    ["#ffffff", "--blue"], ["#ffffff", "--red"]];
  for (const scheme of ["light", "dark"]) {
    await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
    const css = await page.evaluate((names) => Object.fromEntries(names.map((name) => [name,
      name[0] === "#" ? name : getComputedStyle(document.documentElement).getPropertyValue(name).trim()])), [...new Set(kPairs.flat())]);
    for (const [ink, ground] of kPairs) {
      const [a, b] = [css[ink], css[ground]].map((color) => light(color.length < 6 ? color.replace(/[0-9a-f]/gi, "$&$&") : color)).sort((x, y) => y - x);
      assert.ok((a + 0.05) / (b + 0.05) >= 4.5, `${scheme}: ${ink} on ${ground} has ${((a + 0.05) / (b + 0.05)).toFixed(2)}`);
    }
  }
}

/** Numbers that are none, as a broken sensor gives them, neither stop the page nor take the robot away. */
async function checkMissingNumbers(page, t) {
  const before = await page.evaluate((time) => {
    const { run, seek } = window.sandrunner, row = run.frames.countUntil(time) - 1;
    seek(time);
    for (const columns of Object.values(run.frames.columns)) {
      if (columns === run.frames.columns.t_s) continue;
      for (const column of columns) if (column instanceof Float32Array || column instanceof Float64Array) column[row] = NaN;
    }
    seek(time);
    return window.sandrunner.feet().flat();
  }, t);
  assert.ok(before.every(Number.isFinite), "the robot stays where it was last known to be");
}

await openFile(browserPath, `${folder}/run.html`, kSoftware, { width: 900, height: 560 }, async (page) => {
  assert.equal(await page.evaluate("sandrunner.kind"), "3d");
  const worst = await checkFeet(page), t = deepMoment();
  await checkHoles(page, t);
  const image = await picture(page, t), share = shares(image);
  within(share, "sand", 0.45, 0.9);
  within(share, "sky", 0.05, 0.35);
  within(share, "force", 0.0005, 0.03);
  within(share, "dark", 0.004, 0.15);
  within(share, "orange", 0.0005, 0.05);
  await checkDarkness(page, t);
  await checkWholeRun(page);
  await checkMissingNumbers(page, t);
  await checkContrast(page);
  const ready = await page.evaluate("sandrunner.ready_ms");
  console.log(`WebGL: feet within ${(1e6 * worst).toFixed(2)} um at 50 times, ready after ${ready.toFixed(0)} ms, shares ${JSON.stringify(share)}`);
});

await openFile(browserPath, `${folder}/run.html`, kNoGraphics, { width: 700, height: 500 }, async (page) => {
  assert.equal(await page.evaluate("sandrunner.kind"), "plots");
  assert.match(await page.$eval("#note", (note) => note.textContent), /no WebGL/);
  const worst = await checkFeet(page);
  await checkWholeRun(page);
  console.log(`no WebGL: plots, feet within ${(1e6 * worst).toFixed(2)} um at 50 times`);
});

const size = fs.statSync(`${folder}/run.html`).size;
assert.ok(size < 2e6, `${size} bytes`);
console.log(`run.html: ${size} bytes for ${lines.length} frames`);
