// SPDX-License-Identifier: BSD-3-Clause
// A page that is opened from the disk, and what its pictures hold.
import assert from "node:assert/strict";
import puppeteer from "puppeteer-core";

export const kSoftware = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** Opens a page from the disk, lets `look` look at it, and requires that it asked for nothing and had no errors. */
export async function openFile(browserPath, file, flags, viewport, look) {
  const args = ["--no-sandbox", "--hide-scrollbars", ...flags];
  const browser = await puppeteer.launch({ executablePath: browserPath, headless: "shell", args, protocolTimeout: 120000 });
  try {
    const page = await browser.newPage();
    await page.setViewport(viewport);
    const [errors, requests] = [[], []];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => { if (message.type() === "error") errors.push(message.text()); });
    page.on("request", (request) => { if (!/^(data|blob):/.test(request.url())) requests.push(request.url()); });
    // #light: what a machine without a graphics card can draw.
    const url = `file://${file}`;
    await page.goto(`${url}#light`);
    await page.waitForFunction("window.sandrunner", { timeout: 60000 });
    await page.evaluate("sandrunner.player.playing = false");
    await look(page);
    assert.deepEqual(errors, []);
    assert.deepEqual(requests.map((request) => request.split("#")[0]), [url], "the page asks for nothing but itself");
  } finally {
    await browser.close();
  }
}

/** The page's picture as {width, height, at(x, y)}: the canvas as it was just drawn. */
export async function picture(page, t) {
  const shot = await page.evaluate((time) => {
    const { view } = window.sandrunner;
    window.sandrunner.seek(time);
    view.renderer?.render(view.scene, view.camera);
    const canvas = document.getElementById("scene"), copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const g = copy.getContext("2d");
    g.drawImage(canvas, 0, 0);
    const bytes = g.getImageData(0, 0, copy.width, copy.height).data;
    let text = "";
    for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
    return { width: copy.width, height: copy.height, text: btoa(text) };
  }, t);
  const bytes = Buffer.from(shot.text, "base64");
  return { ...shot, at: (x, y) => [...bytes.subarray(4 * (y * shot.width + x), 4 * (y * shot.width + x) + 3)] };
}

/** What the ground looks like at time t of the run, as a number. */
export const groundAt = (page, t) => page.evaluate((time) => {
  window.sandrunner.seek(time);
  return window.sandrunner.view.heights.texels.reduce((hash, texel) => (Math.imul(hash, 31) + texel) | 0, 0);
}, t);

const kKinds = {
  sand: ([r, g, b]) => r > g && g > b && r - b > 25 && r > 90 && r - g < 70,
  sky: ([r, g, b]) => b >= r && b > 190 && b - r < 90,
  force: ([r, g, b]) => r > 90 && g < 0.45 * r && b < 0.45 * r,
  dark: ([r, g, b]) => Math.max(r, g, b) < 75,
  orange: ([r, g, b]) => r > 190 && g > 90 && g < 160 && b < 70,
};

/** Share of the pixels of each kind. */
export function shares({ width, height, at }) {
  const counts = Object.fromEntries(Object.keys(kKinds).map((kind) => [kind, 0]));
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) for (const kind in kKinds) counts[kind] += kKinds[kind](at(x, y)) ? 1 : 0;
  }
  for (const kind in counts) counts[kind] /= width * height;
  return counts;
}

export function within(share, kind, low, high) {
  assert.ok(share[kind] >= low && share[kind] <= high, `${kind}: share ${share[kind]} of the pixels, expected ${low} to ${high}`);
}
