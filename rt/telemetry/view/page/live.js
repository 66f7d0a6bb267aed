// SPDX-License-Identifier: BSD-3-Clause
// The source of a page that this computer's sandrunner serves: the same as of a file, but it grows. It connects again
// by itself, keeps what was seen, and begins anew if another run answers. In a sandbox the page serves itself.
import { GrowingTable } from './growing_table.js';
import { tellsTruth } from './moment.js';

const kMostFrames = 60000, kMostPrints = 8192, kMostTiles = 2048, kAgain_ms = 500, kLost_ms = 500, kLook_ms = 100;

/** The key of this server, taken out of the address bar; '' without. */
function takeKey() {
  const [, given, light] = /^#key=(\w+)(&light)?$/.exec(location.hash) ?? [];
  if (given) {
    sessionStorage.setItem('key', given);
    history.replaceState(null, '', location.pathname + (light ? '#light' : ''));
  }
  return sessionStorage.getItem('key') ?? '';
}

export class Live {
  /** @param {Function} begin gets {hello, frames, footprints, tiles, live} once there is something to draw
   * @param {Function} open makes a socket; null: to the server of the page */
  constructor(begin, open = null) {
    this.begin = begin;
    this.open = open ?? (() => new WebSocket(`ws://${location.host}/live`));
    this.key = open ? '' : takeKey();
    this.state = { t_s: 0, ended: false, paused: false, rate: 1 };
    this.mayTouch = this.hasPace = this.takesCommands = false;
    this.onAnswer = this.onState = this.onRun = () => {};
    this.silent_ms = 0;
    // Looks are counted, not the time between them: a page that was held up could not hear, and what it missed is waiting.
    setInterval(() => { this.silent_ms += kLook_ms; }, kLook_ms);
    this.#connect();
  }

  /** Nothing was heard for too long to believe what is shown; of a recording all that there is to hear was heard. */
  get lost() { return !this.recorded && this.silent_ms > kLost_ms; }

  /** @param {object} message as view_messages.h has them */
  say(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  #connect() {
    const socket = this.socket = this.open();
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => this.say({ say: 'hello', key: this.key });
    socket.onmessage = ({ data }) => {
      this.silent_ms = 0;
      if (typeof data === 'string') this.#text(JSON.parse(data)); else this.#rows(data);
    };
    socket.onclose = () => {
      this.silent_ms = Infinity;  // what ended is lost at once, what is only silent after a while
      setTimeout(() => this.#connect(), kAgain_ms);
    };
  }

  #text(message) {
    if (message.say === 'state' && this.run) {
      this.state = message;
      this.onState(message);
      if (message.ended) this.#start();  // the server says so behind all that was seen
    } else if (message.say === 'hello') {
      this.#hello(message);
    } else {
      this.onAnswer(message);
    }
  }

  #hello({ run, key, pace, drive, recorded, hello }) {
    this.mayTouch = key;
    this.takesCommands = drive;
    this.recorded = recorded;
    this.hasPace = pace;
    const another = this.name !== undefined && this.name !== run;
    this.name = run;
    if (!this.run) {
      this.run = {
        hello,
        frames: new GrowingTable(hello.frame_fields, kMostFrames, hello.row_flags),
        footprints: new GrowingTable(hello.footprint_fields, kMostPrints),
        tiles: new GrowingTable(hello.tile_fields, kMostTiles),
      };
    } else if (another) {
      if (hello.urdf !== this.run.hello.urdf || hello.terrain !== this.run.hello.terrain) location.reload();
      for (const table of [this.run.frames, this.run.footprints, this.run.tiles]) table.clear();
      this.onRun();
    }
  }

  #rows(buffer) {
    const [kind, count] = new Uint32Array(buffer, 0, 2);
    const table = this.run[this.run.hello.row_kinds[kind]], rows = new DataView(buffer, 8);
    // After a break the server sends its past again.
    const last = table.count - 1;
    const isOld = table === this.run.tiles ? (at) => this.#hasTile(at('tile_x'), at('tile_y')) : (at) => last >= 0 && at('t_s') <= table.time(last);
    table.append(rows, count, isOld);
    if (!this.recorded) this.#start();
  }

  #hasTile(x, y) {
    const { tiles } = this.run;
    for (let i = 0; i < tiles.count; ++i) if (tiles.at(i, 'tile_x') === x && tiles.at(i, 'tile_y') === y) return true;
    return false;
  }

  #start() {
    const { run } = this;
    if (run.live || run.frames.count < 2) return;
    run.live = this;
    if (!tellsTruth(run.frames)) {
      run.hello.note = `${run.hello.note} ${run.hello.no_truth}`.trim();
    }
    if (!this.mayTouch && !this.recorded) {
      run.hello.note = `${run.hello.note} Watching only: to drive the robot, open the address that sandrunner printed, with its key.`.trim();
    }
    this.begin(this.run);
  }
}
