// SPDX-License-Identifier: BSD-3-Clause
// The shown time of a run: plays, stops, goes where it is asked to.

export class Player {
  constructor(frames) {
    this.frames = frames;
    this.t = this.begin;
    this.rate = 1;
    this.playing = true;
  }

  get begin() { return this.frames.count ? this.frames.time(0) : 0; }
  get end() { return this.frames.count ? this.frames.time(this.frames.count - 1) : 0; }

  toggle() {
    if (!this.playing && this.t >= this.end) this.t = this.begin;
    this.playing = !this.playing;
  }

  /** Stops there. */
  seek(t) {
    this.playing = false;
    this.t = Math.min(this.end, Math.max(this.begin, t));
  }

  /** @param {number} seconds that have passed for the viewer */
  advance(seconds) {
    if (!this.playing) return;
    this.t += this.rate * seconds;
    if (this.t >= this.end) this.seek(this.end);
  }
}
