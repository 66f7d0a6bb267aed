// SPDX-License-Identifier: BSD-3-Clause
// Driving: the keys, limits and habits of sandrunner-ctl drive. A velocity is sent only while something is held; what
// guards the robot from a page that hangs or is gone is the age of its last one, not this file.
import { isForPage } from './keys.js';
import { Stick } from './stick.js';

const kEvery_ms = 50, kZeros = 3, kDeadZone = 0.1;
const kFull = { vx: 1, vy: 0.5, wz: 1 };
const kKeys = { w: ['vx', 1], s: ['vx', -1], a: ['vy', 1], d: ['vy', -1], q: ['wz', 1], e: ['wz', -1] };
const element = (id) => document.getElementById(id);
const beyondDeadZone = (way) => Math.sign(way) * Math.max(Math.abs(way) - kDeadZone, 0) / (1 - kDeadZone);

export class Drive {
  /** @param {object[]} requests {name, key} of each, as hello has them */
  constructor(live, requests) {
    this.live = live;
    this.held = new Set();
    this.stick = new Stick();
    this.tenths = 5;
    this.zeros = 0;
    this.requestKeys = Object.fromEntries(requests.filter(({ key }) => key).map(({ name, key }) => [key, name]));
    for (const { name } of requests) {
      const button = document.createElement('button');
      button.textContent = name.replace('_', ' ');
      button.onclick = () => this.request(name);
      element('requests').append(button);
    }
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
    this.live.say({ say: 'request', name });
  }

  /** What the robot said to a request, or why it did not do something. */
  answer({ say, to, accepted, text, why }) {
    if (say === 'refused') element('refusal').textContent = why;
    else element('answer').textContent = `${to.replace('_', ' ')}: ${accepted ? '' : 'refused, '}${text.replace('_', ' ')}`;
  }

  show() {
    element('drive').hidden = element('touch-drive').hidden = !this.allowed;
    element('scale').textContent = `w a s d q e at ${this.tenths / 10}, + -; space: stop`;
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
    if (wanted) this.zeros = kZeros;
    else if (this.zeros-- <= 0) {
      this.zeros = 0;
      return;
    }
    const velocity = wanted ?? { vx: 0, vy: 0, wz: 0 };
    this.live.say({ say: 'drive', ...Object.fromEntries(Object.entries(kFull).map(([k, full]) => [k, scale * full * velocity[k]])) });
  }
}
