// SPDX-License-Identifier: BSD-3-Clause
// Rows of numbers in columns, ascending in time if they have a t_s.

export class Table {
  static kTypes = { f64: Float64Array, f32: Float32Array, u32: Uint32Array, i32: Int32Array, i16: Int16Array };

  /**
   * @param {number} count of rows
   * @param {Object<string, ArrayLike<number>[]>} columns by field, then number of it
   * @param {Object<string, number>} flags bits of the field `flags` by name, as hello has them; if there is one
   */
  constructor(count, columns, flags) {
    this.count = count;
    this.columns = columns;
    this.flags = flags;
  }

  at(row, field, k = 0) { return this.columns[field][k][row]; }
  all(row, field) { return this.columns[field].map((column) => column[row]); }
  has(row, flag) { return (this.at(row, 'flags') & flag) !== 0; }
  time(row) { return this.columns.t_s[0][row]; }

  /** Rows with t_s <= t. */
  countUntil(t) {
    let low = 0, high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time(middle) <= t) low = middle + 1; else high = middle;
    }
    return low;
  }
}
