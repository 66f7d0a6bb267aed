// SPDX-License-Identifier: BSD-3-Clause
// The time line: where the run is in what mode, how fast it went, faults, and the shown time; pointer and keys move it.
import { isForPage } from './keys.js';
import { context2d, marks, markStep } from './plots.js';
import { kTheme } from './theme.js';

const kModeColors = { passive: '#e3e7eb', damping: '#f3d9b1', stand_up: '#d5e3d0', stand: '#bfdcb8', walk: '#a9c9ea', fault: '#f0a9a4' };
const kInset = 8;

export class Timeline {
  /** @param {object} player {t, begin, end, seek(t), toggle()} */
  constructor(canvas, { hello, frames }, player) {
    Object.assign(this, { canvas, frames, player });
    this.hello = hello;
    const seek = (event) => {
      const { left, width } = canvas.getBoundingClientRect();
      const share = (event.clientX - left - kInset) / (width - 2 * kInset);
      player.seek(player.begin + share * (player.end - player.begin));
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      seek(event);
    });
    canvas.addEventListener('pointermove', (event) => { if (event.buttons) seek(event); });
    window.addEventListener('keydown', (event) => this.#key(event));
  }

  #key(event) {
    if (!isForPage(event)) return;
    if (event.key === ' ' && event.target.tagName === 'BUTTON') return;  // its own click
    const { player, frames } = this, row = frames.countUntil(player.t) - 1;
    const by = (frameStep, s) => (event.shiftKey ? player.seek(player.t + s)
      : player.seek(frames.time(Math.min(frames.count - 1, Math.max(0, row + frameStep)))));
    const actions = {
      ' ': () => player.toggle(),
      ArrowLeft: () => by(-1, -1),
      ArrowRight: () => by(1, 1),
      Home: () => player.seek(player.begin),
      End: () => player.seek(player.end),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }

  draw() {
    this.#takeNew();
    const { g, width, height } = context2d(this.canvas), { begin, end, t } = this.player;
    const x = (at) => kInset + (width - 2 * kInset) * (end > begin ? (at - begin) / (end - begin) : 0);
    const bottom = height - 13;
    for (const { name, from, to } of this.spans) {
      g.fillStyle = kModeColors[name] ?? '#e3e7eb';
      g.fillRect(x(from), 0, Math.max(1, x(to) - x(from)), bottom);
      g.fillStyle = '#3d4650';
      g.font = '10px system-ui, sans-serif';
      g.textAlign = 'left';
      if (g.measureText(name).width + 8 < x(to) - x(from)) g.fillText(name.replace('_', ' '), x(from) + 4, 10);
    }
    g.strokeStyle = '#1d5c99';
    g.beginPath();
    const every = Math.max(1, Math.floor(this.frames.count / width));
    for (let i = 0; i < this.frames.count; i += every) {
      const speed = Math.abs(this.frames.at(i, 'motion', 0));
      if (Number.isFinite(speed)) g.lineTo(x(this.frames.time(i)), bottom - 1 - (bottom - 13) * speed / this.top);
    }
    g.stroke();
    this.#seconds(g, x, width, height);
    g.fillStyle = kTheme.ink;
    g.fillRect(Math.round(x(t)) - 1, 0, 2, height - 11);
    g.beginPath();
    g.arc(x(t), bottom, 5, 0, 2 * Math.PI);
    g.fill();
    this.canvas.setAttribute('aria-valuetext', `${t.toFixed(2)} s`);
  }

  // Frames that came since the last time.
  #takeNew() {
    const { frames } = this;
    if (this.age !== frames.age || !this.spans) Object.assign(this, { age: frames.age, spans: [], top: 0.5, taken: 0 });
    for (; this.taken < frames.count; ++this.taken) {
      this.top = Math.max(this.top, Math.abs(frames.at(this.taken, 'motion', 0)) || 0);
      const name = this.hello.modes[frames.at(this.taken, 'mode')] ?? '', t = frames.time(this.taken);
      const last = this.spans[this.spans.length - 1];
      if (last) last.to = t;
      if (last?.name !== name) this.spans.push({ name, from: t, to: t });
    }
  }

  #seconds(g, x, width, height) {
    const { begin, end } = this.player, step = Math.max(1, markStep(Math.max(end - begin, 1e-3), width / 70));
    g.fillStyle = kTheme.faint;
    g.textAlign = 'center';
    g.font = '10px system-ui, sans-serif';
    for (const at of marks(begin, end, step)) g.fillText(`${at} s`, Math.min(width - 14, Math.max(12, x(at))), height - 1);
  }
}
