// SPDX-License-Identifier: BSD-3-Clause
// The shown time of a run that goes on: follows its newest frame, or looks back while the robot goes on.
import { Player } from './player.js';

const kBehind_s = 0.02;  // the frames between which the newest picture lies
const kSmooth_s = 0.05;  // frames come in batches; the shown time glides

export class LivePlayer extends Player {
  constructor({ frames, live }) {
    super(frames);
    this.t = live.recorded ? this.begin : this.end;
    this.following = !live.recorded;
  }

  toggle() {
    super.toggle();
    this.following = false;
  }

  /** Back to what is now. */
  follow() { this.playing = this.following = true; }

  seek(t) {
    super.seek(t);
    this.following = false;
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
