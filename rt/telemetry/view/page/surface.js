// SPDX-License-Identifier: BSD-3-Clause
// The undisturbed ground: a plane, and the waves on it in tiles of heights (view_tiles.h).

export class Surface {
  /** @param {object} run {hello, tiles} */
  constructor({ hello, tiles }) {
    this.step = hello.tile_step_m;
    this.side = hello.tile_side;
    this.slope = hello.slope;
    this.table = tiles;
    this.takeNew();
  }

  /** Takes what came since the last time; returns the squares [x0, y0, x1, y1], m, that it covers. */
  takeNew() {
    const { table } = this, size = this.step * this.side, squares = [];
    if (!this.rows || this.age !== table.age) Object.assign(this, { age: table.age, rows: new Map(), taken: 0 });
    for (; this.taken < table.count; ++this.taken) {
      const x = table.at(this.taken, 'tile_x'), y = table.at(this.taken, 'tile_y');
      this.rows.set(`${x} ${y}`, this.taken);
      squares.push([x * size, y * size, (x + 1) * size, (y + 1) * size]);
    }
    this.flat = this.rows.size === 0;
    return squares;
  }

  /** Its height at x, y, m; that of the plane where no tile is known. */
  at(x, y) { return this.slope[0] * x + this.slope[1] * y + this.waves(x, y); }

  /** Height over the plane, m. */
  waves(x, y) {
    if (this.flat) return 0;
    const u = x / this.step, v = y / this.step, i = Math.floor(u), j = Math.floor(v);
    const a = this.#corner(i, j), b = this.#corner(i + 1, j), c = this.#corner(i, j + 1), d = this.#corner(i + 1, j + 1);
    return a + (b - a) * (u - i) + (c - a) * (v - j) + (a - b - c + d) * (u - i) * (v - j);
  }

  #corner(i, j) {
    const n = this.side, x = Math.floor(i / n), y = Math.floor(j / n), row = this.rows.get(`${x} ${y}`);
    return row === undefined ? 0 : 1e-4 * this.table.at(row, 'height_tenth_mm', (j - n * y) * n + (i - n * x));
  }
}
