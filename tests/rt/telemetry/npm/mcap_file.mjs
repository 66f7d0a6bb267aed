// SPDX-License-Identifier: BSD-3-Clause
// A whole MCAP file through @mcap/core; each CRC must be there and right.
import assert from "node:assert/strict";
import { crc32 } from "@foxglove/crc";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";

const decompressHandlers = { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) };

/// As a stream: onMessage for each message; returns all other records by their type.
export function readStream(bytes, onMessage) {
  const records = {};
  // Checks the CRCs of chunks and attachments.
  const stream = new McapStreamReader({ includeChunks: true, validateCrcs: true, decompressHandlers });
  for (let at = 0; at < bytes.length; at += 65536) {
    stream.append(bytes.subarray(at, at + 65536));
    for (let record; (record = stream.nextRecord()); ) {
      if (record.type === "Message") onMessage(record);
      else (records[record.type] ??= []).push(record);
    }
  }
  assert.ok(stream.done(), "the file is complete");
  assert.equal(records.Header[0].profile, "ros2");
  assert.match(records.Header[0].library, /^sandrunner \d/);
  for (const chunk of records.Chunk) {
    assert.equal(chunk.compression, "zstd");
    assert.notEqual(chunk.uncompressedCrc, 0);
  }
  // The one CRC that the package leaves to its user: of everything in front of the record DataEnd, 13 bytes long.
  const dataEndAt = Number(records.Footer[0].summaryStart) - 13;
  assert.equal(records.DataEnd[0].dataSectionCrc, crc32(bytes.subarray(0, dataEndAt)));
  assert.notEqual(records.Footer[0].summaryCrc, 0);
  return records;
}

/// Through the summary and the indexes. The reader checks the CRC of the summary.
export function openIndexed(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.slice(Number(offset), Number(offset + size)),
  };
  return McapIndexedReader.Initialize({ readable, decompressHandlers });
}

export async function all(generator) {
  const result = [];
  for await (const record of generator) result.push(record);
  return result;
}
