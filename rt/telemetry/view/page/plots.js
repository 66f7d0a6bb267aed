// SPDX-License-Identifier: BSD-3-Clause
// A strip chart: lines over the seconds before the shown time, on a canvas.
import { kTheme } from './theme.js';

/** A canvas's 2D context for drawing in CSS pixels; its size follows the element's. */
export function context2d(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const g = canvas.getContext('2d');
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  return { g, width, height };
}

/** The distance of marks on an axis that has about `wanted` of them. */
export function markStep(range, wanted) {
  const rough = range / wanted, power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5, 10].find((m) => m * power >= rough) ?? 10);
}

/** The multiples of `step` from `low` to `high`; counted, as a step more may be no other number. */
export function marks(low, high, step) {
  const first = Math.ceil(low / step), count = Math.floor(high / step) - first + 1;
  return Array.from({ length: Math.max(0, count) }, (_, i) => (first + i) * step);
}

const digitsOf = (step) => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));

const kPointsPerPixel = 8;  // of a line; in fewer, the peaks of a whole run would not show
const kLeft = 40, kRight = 8, kSwatch = 12, kFont = 'system-ui, sans-serif';

export class Strip {
  /**
   * @param {Element} parent gets its canvas
   * @param {object[]} lines {name, color, value(row), dash?, wide?}
   * @param {object} more limits: values of dashed red lines, always in sight; least: smallest range of the axis;
   *   zero: the axis holds 0; marks: unit of the times that stand below it; pointed: time of an upright line
   */
  constructor(parent, title, unit, lines, more = {}) {
    const canvas = parent.appendChild(document.createElement('canvas'));
    Object.assign(this, { canvas, title, unit, lines, limits: [], least: 0.1, zero: false, marks: '', pointed: NaN, ...more });
    this.top = this.marks ? 35 : 21;  // names below the title: values stand beside them
    this.bottom = this.marks ? 19 : 7;
  }

  draw(frames, t, span) {
    const { g, width, height } = context2d(this.canvas);
    if (width === 0) return;
    const from = t - span, first = Math.max(0, frames.countUntil(from) - 1), behind = frames.countUntil(t);
    const every = Math.max(1, Math.floor((behind - first) / (kPointsPerPixel * (width - kLeft - kRight))));
    const series = this.lines.map(({ value }) => {
      const points = [];
      for (let i = first; i < behind; i += every) points.push(value(i));
      return points;
    });
    const [low, high] = this.#range(series);
    const x = (at) => kLeft + (width - kLeft - kRight) * (at - from) / span;
    const y = (value) => this.top + (height - this.top - this.bottom) * (high - value) / (high - low);
    this.#axis(g, width, low, high, y);
    g.save();
    g.beginPath();
    g.rect(kLeft, this.top - 2, width - kLeft - kRight, height - this.top - this.bottom + 4);
    g.clip();
    this.lines.forEach(({ color, dash, wide }, n) => {
      g.strokeStyle = color;
      g.lineWidth = wide ? 3.5 : 1.4;
      g.setLineDash(dash ?? []);
      g.beginPath();
      let drawing = false;
      series[n].forEach((value, k) => {
        if (Number.isFinite(value)) g[drawing ? 'lineTo' : 'moveTo'](x(frames.time(first + k * every)), y(value));
        drawing = Number.isFinite(value);
      });
      g.stroke();
    });
    if (this.pointed >= from) {
      g.fillStyle = kTheme.faint;
      g.fillRect(Math.round(x(this.pointed)), 0, 1, height);
    }
    g.restore();
    if (this.marks) this.#times(g, x, from, t, width, height);
    this.#head(g, width);
  }

  /** The time under a place that is `offset` pixels from the left side. */
  timeAt(offset, t, span) {
    return t - span + span * (offset - kLeft) / (this.canvas.clientWidth - kLeft - kRight);
  }

  #range(series) {
    let low = this.zero ? 0 : Infinity, high = this.zero ? 0 : -Infinity;
    for (const value of [...series.flat(), ...this.limits]) {
      if (!Number.isFinite(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    if (low > high) [low, high] = [0, 1];
    const missing = Math.max(0, this.least - (high - low)) / 2, pad = 0.06 * (high - low + 2 * missing);
    return [low - missing - pad, high + missing + pad];
  }

  #axis(g, width, low, high, y) {
    const step = markStep(high - low, 4), digits = digitsOf(step);
    g.font = `10px ${kFont}`;
    g.textAlign = 'right';
    g.lineWidth = 1;
    const line = (value, color, dash) => {
      g.strokeStyle = color;
      g.setLineDash(dash);
      g.beginPath();
      g.moveTo(kLeft, Math.round(y(value)) + 0.5);
      g.lineTo(width - kRight, Math.round(y(value)) + 0.5);
      g.stroke();
    };
    for (const value of marks(low, high, step)) {
      line(value, value === 0 ? kTheme.zero : kTheme.grid, []);
      g.fillStyle = kTheme.faint;
      g.fillText(value.toFixed(digits), kLeft - 5, y(value) + 3.5);
    }
    for (const limit of this.limits) line(limit, kTheme.limit, [5, 3]);
    g.setLineDash([]);
  }

  #times(g, x, from, t, width, height) {
    const step = markStep(t - from, 5), digits = digitsOf(step);
    g.textAlign = 'center';
    for (const at of marks(from, t, step)) g.fillText(at.toFixed(digits) + this.marks, Math.min(width - 16, x(at)), height - 6);
  }

  #head(g, width) {
    g.textAlign = 'left';
    g.fillStyle = kTheme.ink;
    g.font = `600 11.5px ${kFont}`;
    g.fillText(this.title, 8, 14);
    let x = 8 + g.measureText(this.title).width + 5;
    g.font = `10.5px ${kFont}`;
    g.fillStyle = kTheme.faint;
    g.fillText(this.unit, x, 14);
    g.textAlign = 'right';
    x = width - kRight;
    g.fillStyle = kTheme.ink;
    for (const { name, color, dash, wide } of [...this.lines].reverse()) {
      if (!name) continue;
      g.fillText(name, x, this.top - 7);
      x -= g.measureText(name).width + 4;
      g.strokeStyle = color;
      g.lineWidth = wide ? 3.5 : 2;
      g.setLineDash(dash ?? []);
      g.beginPath();
      g.moveTo(x, this.top - 10.5);
      g.lineTo(x -= kSwatch, this.top - 10.5);
      g.stroke();
      x -= 8;
    }
    g.setLineDash([]);
  }
}
