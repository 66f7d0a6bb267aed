// SPDX-License-Identifier: BSD-3-Clause
// The undisturbed ground: flat at 0, or tiles of heights (view_tiles.h).

export class Surface {
  /** @param {object} run {hello, tiles} */
  constructor({ hello, tiles }) {
    this.step = hello.tile_step_m;
    this.side = hello.tile_side;
    this.table = tiles;
    this.rows = new Map();
    for (let i = 0; i < tiles.count; ++i) this.rows.set(`${tiles.at(i, 'tile_x')} ${tiles.at(i, 'tile_y')}`, i);
    this.flat = tiles.count === 0;
  }

  /** Its height at x, y, m; 0 where nothing is known. */
  at(x, y) {
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
