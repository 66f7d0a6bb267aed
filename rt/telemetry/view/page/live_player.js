// SPDX-License-Identifier: BSD-3-Clause
// The shown time of a run that goes on: follows its newest frame, or looks back while the robot goes on.

const kBehind_s = 0.02;  // the frames between which the newest picture lies
const kSmooth_s = 0.05;  // frames come in batches; the shown time glides

export class LivePlayer {
  constructor({ frames, live }) {
    this.frames = frames;
    this.rate = 1;
    this.t = live.recorded ? this.begin : this.end;
    this.playing = true;
    this.following = !live.recorded;
  }

  get begin() { return this.frames.count ? this.frames.time(0) : 0; }
  get end() { return this.frames.count ? this.frames.time(this.frames.count - 1) : 0; }

  toggle() {
    if (!this.playing && this.t >= this.end) this.t = this.begin;
    this.playing = !this.playing;
    this.following = false;
  }

  /** Back to what is now. */
  follow() { this.playing = this.following = true; }

  /** Stops there. */
  seek(t) {
    this.playing = this.following = false;
    this.t = Math.min(this.end, Math.max(this.begin, t));
  }

  /** @param {number} seconds that have passed for the viewer */
  advance(seconds) {
    if (!this.playing) return;
    const newest = Math.max(this.begin, this.end - kBehind_s);
    if (!this.following) {
      this.t = Math.max(this.begin, this.t + this.rate * seconds);
      if (this.t >= newest) this.following = true;
    }
    if (!this.following) return;
    const behind = newest - this.t;
    // After a break, or of another run, there is nothing to glide over.
    this.t = Math.abs(behind) > 0.5 ? newest : this.t + behind * Math.min(1, seconds / kSmooth_s);
  }
}
