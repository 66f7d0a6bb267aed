// SPDX-License-Identifier: BSD-3-Clause
// node check_modules.mjs SANDRUNNER SANDBOX FOLDER: the modules of pages that SANDBOX writes into FOLDER end in the states of
// SANDRUNNER, on several grounds, for two robots, and with the policies in FOLDER; a module whose fma is not fused is refused.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { Page, run } from "./page_module.mjs";

const [sandrunner, sandbox, folder] = process.argv.slice(2);
const kModules = ["relaxed", "exact"];
const kCases = [
  ...["dry-sand", "wet-sand", "grass", "athletic-track", "vinyl", "rigid"].map((preset) => ["--terrain", preset]),
  ["--robot", "go2", "--set", "terrain.roughness_m=0.01"],
  ...["tcn", "perceptron"].map((name) => ["--policy", `${folder}/${name}.safetensors`]),
];

function nativeHash(words) {
  const said = spawnSync(sandrunner, words, { encoding: "utf8" }).stdout;  // 1: it fell
  return /state hash\s+([0-9a-f]{16})/.exec(said)[1];
}

for (const words of kCases) {
  const file = `${folder}/page.html`;
  execFileSync(sandbox, [...words, "--out", file]);
  const page = new Page(file);
  const [walk, whole] = [["--start", "walk", "--duration", "5"], ["--duration", "2"]].map((more) => nativeHash([...words, ...more]));
  assert.equal(page.sandbox.hash, nativeHash(words), `${words}: the hash in the page`);
  for (const name of kModules) {
    const module = page.load(name);
    assert.equal(module.fma_is_fused(), 1, `${name}: the fma of this processor`);
    const walked = run(module, true, 5);
    assert.equal(walked.hash, walk, `${words}, ${name}: 5 s of walking`);
    assert.equal(run(module, false, 2).hash, whole, `${words}, ${name}: a whole run`);
    console.log(`${words.join(" ")}, ${name}: ${walked.hash} and ${whole}, ${(walked.length_s / walked.cpu_s).toFixed(1)} x real time`);
  }
}

// On a processor without it, V8 makes of the relaxed one a product and a sum.
const without = execFileSync(process.execPath, ["--no-enable-fma3", "--input-type=module", "-e", `
  import { Page } from "${import.meta.dirname ?? new URL(".", import.meta.url).pathname}/page_module.mjs";
  const page = new Page("${folder}/page.html");
  console.log(page.load("relaxed").fma_is_fused(), page.load("exact").fma_is_fused());`], { encoding: "utf8" });
if (process.arch === "x64") assert.equal(without.trim(), "0 1", "without the processor's fma");
