// SPDX-License-Identifier: BSD-3-Clause
// Heights of the ground over its plane, around the robot: a square window on the world that wraps around, into which
// footprints are pressed. What it holds depends on time and place alone, not on the way there: looking back shows the same.

export const kCell_m = 0.005, kSide = 2048, kWindow_m = kCell_m * kSide;
const kBlock = 64;  // cells; the window moves by whole blocks
const kRimWidth_m = 0.014, kSteepness = 1.5, kReach_m = 0.06;

/** Bits of the nearest half-precision float. */
const half = (() => {
  const number = new Float32Array(1), bits = new Uint32Array(number.buffer);
  return (value) => {
    number[0] = value;
    const x = bits[0] + 0x1000, sign = (x >>> 16) & 0x8000, exponent = ((x >>> 23) & 255) - 112;
    if (exponent <= 0) return sign;
    return exponent >= 31 ? sign | 0x7c00 : sign | (exponent << 10) | ((x >>> 13) & 0x3ff);
  };
})();

const wrap = (cell) => cell & (kSide - 1);

export class Heights {
  /** @param {object} run {hello, footprints}  @param {Surface} surface */
  constructor({ hello, footprints }, surface) {
    this.prints = footprints;
    this.radius = hello.foot_radius_m;
    this.surface = surface;
    this.lasting = new Float32Array(kSide * kSide);  // less what only the feet of this very moment press
    this.texels = new Uint16Array(kSide * kSide);    // what is shown, in halves
    this.changed = [];  // rectangles of world cells [x0, y0, x1, y1) of `texels`, since it was last emptied
    this.pressed = 0;   // footprints in it
    this.feet = [];     // rectangles that feet press at this moment
    this.x0 = this.y0 = NaN;
  }

  /** As shown at x, y, less the undisturbed ground: the rim is above 0, a hole below. */
  pressedAt(x, y) {
    const i = wrap(Math.floor(y / kCell_m)) * kSide + wrap(Math.floor(x / kCell_m));
    return this.lasting[i];
  }

  /**
   * Shows time t with x, y in the middle.
   * @param {number[]} stance x, y, depth of each foot where it is deepest in its present stance; depth 0: in the air
   */
  show(t, x, y, stance) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) return;
    const corner = (v) => Math.round((v / kCell_m - kSide / 2) / kBlock) * kBlock;
    const x0 = corner(x), y0 = corner(y), until = this.prints.count ? this.prints.countUntil(t) : 0;
    if (this.age !== this.prints.age) this.pressed = Infinity;  // other rows than before
    this.age = this.prints.age;
    const far = !(Math.abs(x0 - this.x0) < kSide && Math.abs(y0 - this.y0) < kSide);
    this.#liftFeet();
    if (far || until < this.pressed) {
      this.x0 = x0;
      this.y0 = y0;
      this.pressed = until;
      this.#fill([x0, y0, x0 + kSide, y0 + kSide]);
    } else {
      this.#move(x0, y0);
      for (; this.pressed < until; ++this.pressed) this.#pressPrint(this.pressed, this.#all());
    }
    for (let k = 0; k + 2 < stance.length; k += 3) {
      if (stance[k + 2] > 0.002) this.#pressFoot(stance[k], stance[k + 1], stance[k + 2]);
    }
  }

  /** The undisturbed ground there is known now: [x0, y0, x1, y1], m. */
  groundCame(square) {
    const [x0, y0, x1, y1] = square.map((v) => Math.round(v / kCell_m));
    // Its edges are between its own heights and the neighbours'.
    if (!Number.isNaN(this.x0)) this.#publish([x0 - 10, y0 - 10, x1 + 10, y1 + 10]);
  }

  #all() { return [this.x0, this.y0, this.x0 + kSide, this.y0 + kSide]; }

  // Moves the window: fills what comes into it, a strip along x and one along y.
  #move(x0, y0) {
    const dx = x0 - this.x0, dy = y0 - this.y0, old = this.x0;
    this.x0 = x0;
    this.y0 = y0;
    if (dx) this.#fill(dx > 0 ? [old + kSide, y0, x0 + kSide, y0 + kSide] : [x0, y0, old, y0 + kSide]);
    if (dy) this.#fill(dy > 0 ? [x0, y0 + kSide - dy, x0 + kSide, y0 + kSide] : [x0, y0, x0 + kSide, y0 - dy]);
  }

  // Untouched ground and the footprints so far.
  #fill(rect) {
    const [x0, y0, x1, y1] = rect;
    for (let gy = y0; gy < y1; ++gy) {
      const row = wrap(gy) * kSide;
      for (let gx = x0; gx < x1; ++gx) this.lasting[row + wrap(gx)] = 0;
    }
    this.#publish(rect);
    for (let i = 0; i < this.pressed; ++i) this.#pressPrint(i, rect);
  }

  #pressPrint(i, within) {
    const p = this.prints;
    const rect = this.#press(p.at(i, 'x_m'), p.at(i, 'y_m'), p.at(i, 'depth_m'), within,
      (index, value) => { this.lasting[index] = value; });
    if (rect) this.#publish(rect);
  }

  // Only what is shown: `lasting` stays as it is.
  #pressFoot(x, y, depth) {
    const rect = this.#press(x, y, depth, this.#all(), () => {});
    if (rect) this.feet.push(rect);
  }

  #liftFeet() {
    for (const rect of this.feet) this.#publish(rect);
    this.feet = [];
  }

  // The hole of a foot: as wide as it, walls of some 55 degrees that are not quite round, and the rim that is thrown up.
  // Drawn, not simulated. The deepest of several holes counts, then the highest of several rims, whatever their order.
  #press(x, y, depth, within, keep) {
    const reach = this.radius + depth / kSteepness + kReach_m;
    const rect = [
      Math.max(within[0], Math.floor((x - reach) / kCell_m)), Math.max(within[1], Math.floor((y - reach) / kCell_m)),
      Math.min(within[2], Math.ceil((x + reach) / kCell_m)), Math.min(within[3], Math.ceil((y + reach) / kCell_m)),
    ];
    if (!(rect[0] < rect[2] && rect[1] < rect[3])) return null;
    const turn = 40 * x + 70 * y;
    for (let gy = rect[1]; gy < rect[3]; ++gy) {
      for (let gx = rect[0]; gx < rect[2]; ++gx) {
        const dx = (gx + 0.5) * kCell_m - x, dy = (gy + 0.5) * kCell_m - y, angle = Math.atan2(dy, dx);
        const uneven = 0.10 * Math.sin(3 * angle + turn) + 0.07 * Math.sin(7 * angle - turn);
        const d = Math.hypot(dx, dy), wall = this.radius + depth / kSteepness * (1 + 0.8 * uneven);
        const steep = depth / (wall - this.radius);
        const hole = Math.min(0, -depth + steep * Math.max(0, d - 0.9 * this.radius));
        const rim = (d - wall) / kRimWidth_m - 0.5;
        const raised = Math.max(0, 0.17 * depth * (1 + 2 * uneven) * Math.exp(-rim * rim) - 0.0004);
        const index = wrap(gy) * kSide + wrap(gx), before = this.lasting[index];
        const value = hole < 0 ? Math.min(before, hole) : before < 0 ? before : Math.max(before, raised);
        keep(index, value);
        this.texels[index] = half(value + this.#surfaceOfCell(gx, gy));
      }
    }
    this.changed.push(rect);
    return rect;
  }

  #surfaceOfCell(gx, gy) {
    return this.surface.flat ? 0 : this.surface.waves((gx + 0.5) * kCell_m, (gy + 0.5) * kCell_m);
  }

  #publish(rect) {
    const [x0, y0, x1, y1] = rect;
    for (let gy = Math.max(y0, this.y0); gy < Math.min(y1, this.y0 + kSide); ++gy) {
      const row = wrap(gy) * kSide;
      for (let gx = Math.max(x0, this.x0); gx < Math.min(x1, this.x0 + kSide); ++gx) {
        const index = row + wrap(gx);
        this.texels[index] = half(this.lasting[index] + this.#surfaceOfCell(gx, gy));
      }
    }
    this.changed.push(rect);
  }
}

/** Parts of a rectangle of world cells where it lies in the texture: [x, y, width, height]. */
export function inTexture([x0, y0, x1, y1]) {
  const cut = (a, b) => {
    const parts = [];
    for (let from = a; from < b;) {
      const size = Math.min(b - from, kSide - wrap(from));
      parts.push([wrap(from), size]);
      from += size;
    }
    return parts;
  };
  return cut(x0, x1).flatMap(([x, w]) => cut(y0, y1).map(([y, h]) => [x, y, w, h]));
}
