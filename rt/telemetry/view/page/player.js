// SPDX-License-Identifier: BSD-3-Clause
// The shown time of a run: plays, stops, goes where it is asked to.

export class Player {
  constructor(frames) {
    this.begin = frames.count ? frames.time(0) : 0;
    this.end = frames.count ? frames.time(frames.count - 1) : 0;
    this.t = this.begin;
    this.rate = 1;
    this.playing = true;
  }

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
