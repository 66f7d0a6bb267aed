// SPDX-License-Identifier: BSD-3-Clause
// A stick for a finger. It counts only while another finger holds the button beside it, as a gamepad's shoulder button.
const element = (id) => document.getElementById(id);

export class Stick {
  /** `x` to the right and `y` up, from -1 to 1; they count while `held`. */
  constructor() {
    this.x = this.y = 0;
    const stick = element('stick'), knob = element('knob'), hold = element('stick-hold');
    const move = (x, y) => {
      const far = Math.max(1, Math.hypot(x, y));
      this.x = x / far;
      this.y = y / far;
      knob.style.transform = `translate(${50 * this.x}%, ${-50 * this.y}%)`;
    };
    const follow = (event) => {
      const { left, top, width, height } = stick.getBoundingClientRect();
      move(2 * (event.clientX - left) / width - 1, 1 - 2 * (event.clientY - top) / height);
    };
    stick.onpointerdown = (event) => {
      stick.setPointerCapture(event.pointerId);
      follow(event);
    };
    stick.onpointermove = (event) => { if (stick.hasPointerCapture(event.pointerId)) follow(event); };
    stick.onlostpointercapture = () => move(0, 0);
    hold.onpointerdown = (event) => {
      hold.setPointerCapture(event.pointerId);
      this.#set(true);
    };
    hold.onpointerup = hold.onpointercancel = hold.onlostpointercapture = () => this.#set(false);
    for (const part of [stick, hold]) part.oncontextmenu = (event) => event.preventDefault();  // of a long touch
    this.#set(false);
  }

  letGo() { this.#set(false); }

  #set(held) {
    this.held = held;
    element('stick-hold').classList.toggle('held', held);
  }
}
