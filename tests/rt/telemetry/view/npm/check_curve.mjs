// SPDX-License-Identifier: BSD-3-Clause
// node check_curve.mjs BROWSER FOLDER: opens FOLDER/curve.html of a training from the disk: it has what FOLDER/curve.csv
// has, draws it, and lets the policy walk.
import assert from "node:assert/strict";
import fs from "node:fs";
import { kSoftware, openFile, picture, shares, within } from "./file_page.mjs";

const [browserPath, folder] = process.argv.slice(2);
const [head, ...rows] = fs.readFileSync(`${folder}/curve.csv`, "utf8").trim().split("\n").map((line) => line.split(","));
const newest = Object.fromEntries(head.map((name, i) => [name, Number(rows[rows.length - 1][i])]));
const near = (a, b) => Math.abs(a - b) <= 1e-4 * Math.abs(b) || (Number.isNaN(b) && a === null);

await openFile(browserPath, `${folder}/curve.html`, kSoftware, { width: 900, height: 640 }, async (page) => {
  const { x, charts } = await page.evaluate("sandrunner.curve");
  assert.equal(x.length, rows.length);
  assert.ok(near(x.at(-1), newest.transitions / 1e6));
  // Each column of the CSV with a figure is a line of a chart; those that share one have short names.
  const measured = head.filter((_, i) => rows.some((row) => Number.isFinite(Number(row[i]))));
  const ends = charts.flatMap(({ lines }) => lines.map(({ values }) => values.at(-1)));
  assert.equal(ends.length, measured.length - 2, "all but iteration and transitions");
  assert.ok(!measured.includes("asymmetry"), "not measured without the mirror loss");
  for (const { title, lines } of charts) if (title in newest) assert.ok(near(lines[0].values.at(-1), newest[title]), title);
  const reward = charts.find(({ title }) => title === "Reward");
  assert.ok(near(reward.lines[0].values.at(-1), newest.reward));

  const inked = () => page.$$eval("#curve canvas", (canvases) => canvases.map((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let blue = 0;
    for (let i = 0; i < data.length; i += 4) blue += data[i + 3] > 128 && data[i + 2] > data[i] + 60 ? 1 : 0;
    return blue;
  }));
  const drawn = await inked();
  assert.equal(drawn.length, charts.length);
  for (const [i, count] of drawn.entries()) assert.ok(count > 100, `${charts[i].title}: ${count} pixels of a line`);

  // The pointer reads the row under it.
  const canvas = await page.$("#curve canvas"), { x: left, y: top, width } = await canvas.boundingBox();
  await page.mouse.move(left + width / 2, top + 60);
  assert.match(await page.$eval("#curve h1", (h1) => h1.textContent), /^At [0-9.]+ million transitions/);

  const share = shares(await picture(page, 0.5));
  within(share, "sand", 0.3, 0.95);
  within(share, "orange", 0.0005, 0.2);
  within(share, "dark", 0.001, 0.3);
  assert.ok((await page.evaluate("sandrunner.frames")) > 30);
});

const size = fs.statSync(`${folder}/curve.html`).size;
assert.ok(size < 2e6, `${size} bytes`);
console.log(`curve.html: ${size} bytes for ${rows.length} rows of ${head.length} columns`);
