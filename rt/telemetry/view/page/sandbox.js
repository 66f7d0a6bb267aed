// SPDX-License-Identifier: BSD-3-Clause
// The other end of a live page, in the page itself: simulator, controller and policy as a WebAssembly module
// (tools/sandbox). To live.js it is a socket, and it says what a server would (view_messages.h, page_session.h).
import { inflate } from './file.js';

const kEvery_ms = 16, kBudget_ms = 12, kState_ms = 200;
const kTicks_per_ms = 4, kChunk_ticks = 40, kMost_ticks = 400, kCompare_ticks = 2000;
const kRowKinds = 3;
const kMissing = 'This browser cannot run the simulator: found no WebAssembly with SIMD, expected one of 2021 or later.';
const kSlow = 'The WebAssembly of this browser or processor has no fused multiply-add: it is computed exactly, which is slower.';

const json = (id) => JSON.parse(document.getElementById(id).textContent);

export const hasSandbox = () => document.getElementById('sandbox') !== null;

async function load(id) {
  const module = await WebAssembly.compile(await inflate(id)), imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    (imports[from] ??= {})[name] = () => { throw new Error(`the module called ${name}`); };
  }
  const { exports } = await WebAssembly.instantiate(module, imports);
  exports._initialize();
  return exports;
}

/** @returns what makes a socket for Live; null: this browser cannot, and the page says so */
export async function openSandbox() {
  const hello = json('hello'), sandbox = json('sandbox');
  let module = await load('relaxed').catch(() => null);
  if (!module?.fma_is_fused()) {
    module = await load('exact').catch(() => null);
    hello.note = `${hello.note} ${kSlow}`;
  }
  if (!module) {
    document.getElementById('note').textContent = kMissing;
    return null;
  }
  const setup = await inflate('setup'), at = module.room(setup.length);
  new Uint8Array(module.memory.buffer).set(setup, at);
  module.take_setup();
  module.begin_page();
  addComparison(module, sandbox);
  return () => new Socket(module, sandbox, hello);
}

/** A button that runs the run of the command line, and shows its state hash next to sandrunner's. */
function addComparison(module, { hash, duration_s, command }) {
  const button = document.createElement('button'), result = document.createElement('div');
  button.id = 'compare';
  result.id = 'compared';
  result.setAttribute('role', 'status');
  button.textContent = 'compare bits';
  button.title = `runs what sandrunner runs with these settings (${duration_s} s of ${command}), and compares the state at its end`;
  document.getElementById('tools').append(button);
  document.getElementById('refusal').before(result);
  button.onclick = async () => {
    button.disabled = true;
    module.begin_script(0, duration_s, ...command.split(',').map(Number));
    while (module.run_script(kCompare_ticks)) {
      result.textContent = `the default run: ${module.script_s().toFixed(1)} s`;
      await new Promise((done) => setTimeout(done));
    }
    const found = BigInt.asUintN(64, module.state_hash()).toString(16).padStart(16, '0');
    result.textContent = `state hash ${found}, sandrunner's ${hash}: ${found === hash ? 'equal' : 'DIFFERENT'}`;
    button.disabled = false;
  };
}

class Socket {
  constructor(module, sandbox, hello) {
    Object.assign(this, { module, sandbox, hello });
    this.readyState = WebSocket.OPEN;
    this.wanted = { preset: '', set: {} };
    this.rate = 1;
    this.paused = false;
    this.#goOn();
    document.addEventListener('visibilitychange', () => this.#goOn());
    setTimeout(() => {
      this.onopen();
      setInterval(() => this.#advance(), kEvery_ms);
      setInterval(() => this.#sayState(), kState_ms);
    });
  }

  #say(message) { this.onmessage({ data: JSON.stringify(message) }); }

  #refuse(why) { this.#say({ say: 'refused', why }); }

  /** The time until now is not caught up with. */
  #goOn() {
    this.last_ms = performance.now();
    this.due_ticks = 0;
  }

  #advance() {
    if (document.hidden || this.paused) {
      this.#goOn();
      return;
    }
    const now_ms = performance.now();
    this.due_ticks = Math.min(this.due_ticks + (now_ms - this.last_ms) * kTicks_per_ms * this.rate, kMost_ticks);
    this.last_ms = now_ms;
    while (this.due_ticks >= 1) {
      const ticks = Math.min(Math.floor(this.due_ticks), kChunk_ticks);
      this.#run(ticks);
      this.due_ticks -= ticks;
      if (performance.now() - now_ms > kBudget_ms) this.due_ticks = 0;  // slower than the clock, but not stuck
    }
  }

  #run(ticks) {
    this.module.run_page(ticks);
    this.#sayRows();
  }

  // Heights first: a page that has a row has the ground under it.
  #sayRows() {
    for (let kind = kRowKinds - 1; kind >= 0; --kind) {
      const count = this.module.row_count(kind), size = this.module.row_size(kind);
      if (count === 0) continue;
      const message = new Uint8Array(8 + count * size);
      message.set(new Uint8Array(Uint32Array.of(kind, count).buffer));
      message.set(new Uint8Array(this.module.memory.buffer, this.module.row_data(kind), count * size), 8);
      this.onmessage({ data: message.buffer });
    }
  }

  #sayState() {
    const { module, sandbox, wanted } = this, kind = module.ground_kind();
    this.#say({
      say: 'state', t_s: module.now_s(), ended: false, paused: this.paused, rate: this.rate,
      ground: {
        ...wanted,
        name: sandbox.presets.find(({ preset }) => preset === wanted.preset)?.name ?? sandbox.terrain,
        kind: sandbox.kinds[kind],
        granular: sandbox.drawn_as_sand[kind],
        presets: sandbox.presets.map(({ preset }) => preset),
        values: Object.fromEntries(sandbox.settings.map(({ key }, i) => [key, module.ground_value(i)])),
      },
    });
  }

  #request(name) {
    const refusal = this.module.request(this.hello.requests.findIndex((request) => request.name === name));
    const bytes = new Uint8Array(this.module.memory.buffer);
    const text = refusal ? new TextDecoder().decode(bytes.subarray(refusal, bytes.indexOf(0, refusal)))
      : `mode ${this.hello.modes[this.module.mode()]}`;
    this.#sayRows();
    this.#say({ say: 'answer', to: name, accepted: refusal === 0, text });
  }

  #setGround({ preset, set }) {
    const { module, sandbox } = this;
    if (sandbox.uneven && preset !== '') {
      this.#refuse('uneven ground cannot be changed for another preset');
      return;
    }
    const settings = Object.entries(set).map(([key, value]) => ({ index: sandbox.settings.findIndex((row) => row.key === key), value }));
    for (const { index, value } of settings) {
      const { key, range } = sandbox.settings[index], [low, high] = range.split(' to ').map(Number);
      if (value >= low && value <= high) continue;
      this.#refuse(`page: terrain.${key}: found ${value}, expected ${range}`);
      return;
    }
    module.choose_ground(sandbox.presets.findIndex((row) => row.preset === preset));
    for (const { index, value } of settings) module.set_ground(index, value);
    module.apply_ground();
    this.wanted = { preset, set };
    this.#sayState();
  }

  /** @param {string} line a message of the page */
  send(line) {
    const message = JSON.parse(line), { module } = this;
    switch (message.say) {
      case 'hello':
        this.#say({ say: 'hello', run: 'sandbox', key: true, pace: true, drive: true, recorded: false, hello: this.hello });
        break;
      case 'drive': module.drive(message.vx, message.vy, message.wz); break;
      case 'request': this.#request(message.name); break;
      case 'push': module.push(message.direction); break;
      case 'set_on_legs': module.set_on_legs(); break;
      case 'terrain': this.#setGround(message); break;
      case 'pace': this.rate = message.rate; break;
      case 'pause': this.paused = message.on; break;
      case 'step':
        this.paused = true;
        this.#run(message.ticks);
        break;
    }
    if (['pace', 'pause', 'step'].includes(message.say)) this.#sayState();
  }
}
