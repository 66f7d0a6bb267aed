// SPDX-License-Identifier: BSD-3-Clause
// A Table that gets rows while it is looked at, and forgets its oldest quarter when it is full.
import { Table } from './table.js';

const kReaders = { f64: 'getFloat64', f32: 'getFloat32', u32: 'getUint32', i32: 'getInt32', i16: 'getInt16' };

export class GrowingTable extends Table {
  /** @param {object[]} fields as hello has them  @param {number} most rows  @param {object} flags as Table's */
  constructor(fields, most, flags) {
    super(0, Object.fromEntries(fields.map(({ name, type, count }) => [name, Array.from({ length: count }, () => new Table.kTypes[type](0))])), flags);
    this.fields = fields;
    this.most = most;
    this.room = 0;
    this.age = 0;  // changes whenever rows are forgotten: row numbers of before are worth nothing
  }

  clear() {
    this.count = 0;
    ++this.age;
  }

  /**
   * @param {DataView} data `count` rows, one after the other
   * @param {Function} isOld whether a row, given as at(field, k), is here already: then it is left out
   */
  append(data, count, isOld) {
    const size = data.byteLength / count;
    for (let row = 0; row < count; ++row) {
      const byName = (name, k = 0) => this.#read(data, row * size, this.fields.find((field) => field.name === name), k);
      if (isOld(byName)) continue;
      if (this.count === this.room) this.#makeRoom();
      for (const field of this.fields) {
        const columns = this.columns[field.name];
        for (let k = 0; k < field.count; ++k) columns[k][this.count] = this.#read(data, row * size, field, k);
      }
      ++this.count;
    }
  }

  #read(data, start, { type, offset }, k) {
    return data[kReaders[type]](start + offset + k * Table.kTypes[type].BYTES_PER_ELEMENT, true);
  }

  #makeRoom() {
    if (this.room < this.most) {
      this.room = Math.min(this.most, Math.max(1024, 2 * this.room));
      this.#columns((old) => {
        const column = new old.constructor(this.room);
        column.set(old);
        return column;
      });
      return;
    }
    const drop = Math.ceil(this.count / 4);
    this.#columns((column) => column.copyWithin(0, drop, this.count));
    this.count -= drop;
    ++this.age;
  }

  #columns(change) {
    for (const name in this.columns) this.columns[name] = this.columns[name].map(change);
  }
}
