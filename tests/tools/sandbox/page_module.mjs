// SPDX-License-Identifier: BSD-3-Clause
// A sandbox page's modules, in node.
import fs from "node:fs";
import v8 from "node:v8";
import zlib from "node:zlib";

v8.setFlagsFromString("--experimental-wasm-relaxed-simd"); // node before 21

export class Page {
  /** @param {string} file as sandrunner-sandbox writes it */
  constructor(file) {
    this.html = fs.readFileSync(file, "utf8");
    this.sandbox = JSON.parse(this.element("sandbox"));
  }

  element(id) {
    const text = new RegExp(`<script type="text/plain" id="${id}">([^<]*)</script>`).exec(this.html)?.[1];
    if (text === undefined) throw new Error(`found no element '${id}' in the page`);
    return text;
  }

  bytes(id) { return zlib.gunzipSync(Buffer.from(this.element(id), "base64")); }

  /** The exports of one of its modules, "relaxed" or "exact", with the setup taken. */
  load(name) {
    const module = new WebAssembly.Module(this.bytes(name)), imports = {};
    for (const { module: from, name: what } of WebAssembly.Module.imports(module)) {
      (imports[from] ??= {})[what] = () => { throw new Error(`the module called ${what}`); };
    }
    const { exports } = new WebAssembly.Instance(module, imports);
    exports._initialize();
    const setup = this.bytes("setup"), at = exports.room(setup.length);
    new Uint8Array(exports.memory.buffer).set(setup, at);
    exports.take_setup();
    return exports;
  }
}

/** Runs a run of the command line; returns its state hash, CPU time and length, s. */
export function run(exports, walking, duration_s, command = [1.5, 0, 0]) {
  const before = process.cpuUsage();
  exports.begin_script(walking ? 1 : 0, duration_s, ...command);
  while (exports.run_script(4000));
  const { user, system } = process.cpuUsage(before);
  return {
    hash: BigInt.asUintN(64, exports.state_hash()).toString(16).padStart(16, "0"),
    cpu_s: 1e-6 * (user + system),
    length_s: exports.script_s(),
  };
}
