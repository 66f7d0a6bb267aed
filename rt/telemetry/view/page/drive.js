// SPDX-License-Identifier: BSD-3-Clause
// Driving: the keys, limits and habits of sandrunner-ctl drive. A velocity is sent only while something is held; what
// guards the robot from a page that hangs or is gone is the age of its last one, not this file.
import { isForPage } from './keys.js';
import { Stick } from './stick.js';

const kEvery_ms = 50, kZeros = 3, kDeadZone = 0.1;
const kAlone_s = 5;  // a stop that this page asked for takes less
const kFull = { vx: 1, vy: 0.5, wz: 1 };
const kTouch = matchMedia('(pointer: coarse)').matches;
const kSteps = ['arm', 'stand', 'walk'];
const kKeys = { w: ['vx', 1], s: ['vx', -1], a: ['vy', 1], d: ['vy', -1], q: ['wz', 1], e: ['wz', -1] };
const element = (id) => document.getElementById(id);
const beyondDeadZone = (way) => Math.sign(way) * Math.max(Math.abs(way) - kDeadZone, 0) / (1 - kDeadZone);

export class Drive {
  /** @param {object} hello its modes; its requests: {name, key, refused} of each, why by mode or '' */
  constructor(live, { modes, requests }) {
    Object.assign(this, { live, modes });
    this.held = new Set();
    this.stick = new Stick();
    this.tenths = 5;
    this.zeros = 0;
    this.requestKeys = Object.fromEntries(requests.filter(({ key }) => key).map(({ name, key }) => [key, name]));
    this.buttons = requests.map((request) => this.#makeButton(request));
    // Before the time line, whose keys these partly are.
    window.addEventListener('keydown', (event) => this.#down(event), { capture: true });
    window.addEventListener('keyup', (event) => this.held.delete(event.key.toLowerCase()));
    window.addEventListener('blur', () => this.#letGo());
    window.addEventListener('pagehide', () => this.#letGo());
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.#letGo(); });
    setInterval(() => this.#send(), kEvery_ms);
    this.show();
  }

  get allowed() { return this.live.takesCommands && this.live.mayTouch && !this.live.state.ended; }

  request(name) {
    this.held.clear();
    this.zeros = 0;
    this.ordered_ms = performance.now();
    this.live.say({ say: 'request', name });
  }

  /** What the robot said to a request, or why it did not do something. */
  answer({ say, to, accepted, text, why }) {
    if (say === 'refused') element('refusal').textContent = why;
    else element('answer').textContent = `${to.replace('_', ' ')}: ${accepted ? '' : 'refused, '}${text.replace('_', ' ')}`;
  }

  show() {
    element('drive').hidden = element('touch-drive').hidden = !this.allowed;
    const speed = `${this.tenths / 10} m/s`;
    const how = kTouch ? `hold the round button and move the stick (${speed})` : `hold W A S D (${speed}), Q E to turn; + - for faster, slower`;
    element('how').textContent = this.mode === 'walk' ? how
      : `to drive: ${this.mode === 'fault' ? 'reset fault, ' : ''}${kSteps.map((name, i) => `${i + 1} ${name}`).join(', ')}`;
  }

  /** The newest mode of the robot, by its number. */
  showMode(number) {
    const before = this.mode, mode = this.modes[number];
    if (mode === before) return;
    this.mode = mode;
    for (const { button, refused } of this.buttons) {
      button.title = refused[number];
      button.setAttribute('aria-disabled', String(refused[number] !== ''));
    }
    const alone_s = (performance.now() - this.ordered_ms) / 1000;
    if (before === 'walk' && mode === 'stand' && alone_s > kAlone_s) {
      element('answer').textContent = `no command for ${alone_s.toFixed(0)} s, so it stands: 3 walk goes on`;
    }
    this.show();
  }

  #makeButton({ name, key, refused }) {
    const button = document.createElement('button'), step = kSteps.indexOf(name) + 1;
    button.dataset.request = name;
    button.append(`${step > 0 ? `${step} ` : ''}${name.replace('_', ' ')}`);
    if (key) {
      const hint = document.createElement('kbd');
      hint.textContent = key === ' ' ? 'space' : key.toUpperCase();
      button.append(' ', hint);
    }
    // What is refused is asked for all the same: the robot says why.
    button.onclick = () => this.request(name);
    element('requests').append(button);
    return { button, refused };
  }

  #down(event) {
    const key = event.key.toLowerCase();
    if (!this.allowed || !isForPage(event)) return;
    if (kKeys[key]) this.held.add(key);
    else if (this.requestKeys[key]) { if (!event.repeat) this.request(this.requestKeys[key]); }
    else if (key === '+' || key === '=') this.tenths = Math.min(20, this.tenths + 1);
    else if (key === '-') this.tenths = Math.max(1, this.tenths - 1);
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.show();
  }

  #letGo() {
    const drove = this.held.size > 0 || this.zeros > 0;
    this.held.clear();
    this.stick.letGo();
    this.zeros = 0;
    if (drove) this.live.say({ say: 'drive', vx: 0, vy: 0, wz: 0 });
  }

  /** What is held, as shares of the full speed; null: nothing. */
  #wanted() {
    const pad = document.hidden ? null : [...(navigator.getGamepads?.() ?? [])].find((p) => p?.buttons[4]?.pressed);
    if (this.held.size === 0 && !pad && !this.stick.held) return null;
    const wanted = { vx: 0, vy: 0, wz: 0 };
    for (const key of this.held) wanted[kKeys[key][0]] += kKeys[key][1];
    if (this.held.size === 0 && this.stick.held) {
      Object.assign(wanted, { vx: this.stick.y, wz: -this.stick.x });
    } else if (this.held.size === 0) {
      const axis = (i) => -beyondDeadZone(pad.axes[i] ?? 0);
      Object.assign(wanted, { vx: axis(1), vy: axis(0), wz: axis(2) });
    }
    return wanted;
  }

  #send() {
    if (!this.allowed) return;
    const wanted = this.#wanted(), scale = this.tenths / 10;
    if (wanted) {
      this.zeros = kZeros;
      this.ordered_ms = performance.now();
    } else if (this.zeros-- <= 0) {
      this.zeros = 0;
      return;
    }
    const velocity = wanted ?? { vx: 0, vy: 0, wz: 0 };
    this.live.say({ say: 'drive', ...Object.fromEntries(Object.entries(kFull).map(([k, full]) => [k, scale * full * velocity[k]])) });
  }
}
