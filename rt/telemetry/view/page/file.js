// SPDX-License-Identifier: BSD-3-Clause
// The source of a page that holds a whole run: hello, frames, footprints and ground in its own elements.
import { Table } from './table.js';

const text = (id) => document.getElementById(id).textContent;

/** Bytes of an element that holds them as gzip and base64. */
export async function inflate(id) {
  const packed = Uint8Array.from(atob(text(id)), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * Puts the planes of pack_rows (view_pack.h) together.
 * @param {object[]} fields of the rows, as hello has them
 * @param {Uint8Array} planes
 * @param {object} flags as Table's
 */
function unpack(fields, planes, flags) {
  const widthOf = (type) => Table.kTypes[type].BYTES_PER_ELEMENT;
  const perRow = fields.reduce((sum, f) => sum + f.count * widthOf(f.type), 0);
  const rows = planes.length / perRow;
  const columns = {};
  let from = 0;
  for (const { name, type, count } of fields) {
    const width = widthOf(type);
    columns[name] = [];
    for (let k = 0; k < count; ++k) {
      const bytes = new Uint8Array(rows * width);
      for (let b = 0; b < width; ++b) for (let row = 0; row < rows; ++row) bytes[row * width + b] = planes[from++];
      columns[name].push(new Table.kTypes[type](bytes.buffer));
    }
  }
  return new Table(rows, columns, flags);
}

/** The learning curve that a training's page has besides; else nothing. */
export async function readCurve() {
  return document.getElementById('curve-data') && JSON.parse(new TextDecoder().decode(await inflate('curve-data')));
}

export const hasRun = () => document.getElementById('frames') !== null;

/** @returns what main.js draws: {hello, frames, footprints, tiles}, the last three as Tables */
export async function readRun() {
  const hello = JSON.parse(text('hello'));
  const [frames, footprints, tiles] = await Promise.all(['frames', 'footprints', 'tiles'].map(inflate));
  return {
    hello,
    frames: unpack(hello.frame_fields, frames, hello.row_flags),
    footprints: unpack(hello.footprint_fields, footprints),
    tiles: unpack(hello.tile_fields, tiles),
  };
}
