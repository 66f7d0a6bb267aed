// SPDX-License-Identifier: BSD-3-Clause
// Programs that serve a page with --view, and the browser that looks at it.
import { spawn } from "node:child_process";
import puppeteer from "puppeteer-core";
import { kSoftware } from "./file_page.mjs";

const children = new Set();

/** Starts a program with --view; resolves to {url, child} once it has said where to look. */
export function serve(program, ...words) {
  const child = spawn(program, [...words, "--view"], { stdio: ["ignore", "ignore", "pipe"] });
  children.add(child);
  return new Promise((resolve, reject) => {
    let said = "";
    child.stderr.on("data", (text) => {
      said += text;
      const url = /look at (\S+)/.exec(said)?.[1];
      if (url) resolve({ url, child });
    });
    child.on("exit", (code) => {
      children.delete(child);
      reject(new Error(`${program} ended with ${code}: ${said}`));
    });
  });
}

/** Ends what serve() started and still runs. */
export function endServers() {
  for (const child of children) child.kill("SIGKILL");
}

export function launch(browserPath) {
  return puppeteer.launch({ executablePath: browserPath, headless: "shell", args: ["--no-sandbox", ...kSoftware], protocolTimeout: 120000 });
}
