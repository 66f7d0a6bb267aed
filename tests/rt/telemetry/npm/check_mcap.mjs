// SPDX-License-Identifier: BSD-3-Clause
// node check_mcap.mjs FILE MESSAGES: reads the recording of ../mcap_sample.h with @mcap/core, once as a stream and once
// through its indexes, and compares everything in it; each CRC must be there and right.
import assert from "node:assert/strict";
import fs from "node:fs";
import { all, openIndexed, readStream } from "./mcap_file.mjs";

const [path, count] = [process.argv[2], Number(process.argv[3])];
const bytes = new Uint8Array(fs.readFileSync(path));
const startNs = 1_700_000_000_000_000_000n;

function expectedMessage(i) {
  const data = new Uint8Array(40 + ((i * 7) % 300));
  for (let j = 0; j < data.length; ++j) data[j] = i * 31 + Math.floor((j * j) / 5);
  const logTime = startNs + BigInt(i) * 250_000n;
  return { channelId: 1 + (i % 3), sequence: Math.floor(i / 3), logTime, publishTime: logTime - 1000n, data };
}

function checkMessage(message, i) {
  const expected = expectedMessage(i);
  for (const key of ["channelId", "sequence", "logTime", "publishTime"]) {
    assert.equal(message[key], expected[key], `${key} of message ${i}`);
  }
  assert.ok(Buffer.from(expected.data).equals(message.data), `data of message ${i}`);
}

const qos = ["offered_qos_profiles", ""];
const expectedChannels = [
  { id: 1, schemaId: 1, topic: "/number", messageEncoding: "cdr", metadata: new Map([qos]) },
  { id: 2, schemaId: 2, topic: "/tick", messageEncoding: "cdr", metadata: new Map([qos, ["rate_hz", "4000"]]) },
  { id: 3, schemaId: 2, topic: "/policy_tick", messageEncoding: "cdr", metadata: new Map() },
];
const expectedSchemas = [
  { id: 1, name: "std_msgs/msg/Int32", encoding: "ros2msg", data: "int32 data\n" },
  { id: 2, name: "sandrunner::Tick", encoding: "omgidl", data: "struct Tick { long long tick; };\n" },
];
const expectedAttachments = [
  { name: "config.toml", mediaType: "application/toml", logTime: startNs, createTime: 5n, data: "gain = 1.0\n" },
  { name: "empty", mediaType: "application/octet-stream", logTime: 0n, createTime: 0n, data: "" },
];
const expectedMetadata = [{ name: "build", metadata: new Map([["compiler", "g++"], ["version", "1"]]) }];

const withText = (record) => ({ ...record, data: new TextDecoder().decode(record.data) });
function checkRecords(records, expected, what) {
  const plain = records.map(({ type, ...rest }) => ("data" in rest ? withText(rest) : rest));
  assert.deepEqual(plain, expected, what);
}

let messages = 0;
const records = readStream(bytes, (message) => checkMessage(message, messages++));
assert.equal(messages, count);
assert.ok(records.Chunk.length >= 4, "several chunks");
// In the data section and again in the summary.
checkRecords(records.Schema, [...expectedSchemas, ...expectedSchemas], "schemas");
checkRecords(records.Channel, [...expectedChannels, ...expectedChannels], "channels");
checkRecords(records.Attachment, expectedAttachments, "attachments");
checkRecords(records.Metadata, expectedMetadata, "metadata");
assert.equal(records.MessageIndex.reduce((sum, index) => sum + index.records.length, 0), count);

const indexed = await openIndexed(bytes);
assert.equal(indexed.chunkIndexes.length, records.Chunk.length);
assert.equal(indexed.summaryOffsetsByOpcode.size, 6);
const { type, ...statistics } = indexed.statistics;
const onChannel = (id) => BigInt(Math.floor((count + 3 - id) / 3));
assert.deepEqual(statistics, {
  messageCount: BigInt(count),
  schemaCount: 2,
  channelCount: 3,
  attachmentCount: 2,
  metadataCount: 1,
  chunkCount: records.Chunk.length,
  messageStartTime: startNs,
  messageEndTime: expectedMessage(count - 1).logTime,
  channelMessageCounts: new Map([1, 2, 3].map((id) => [id, onChannel(id)])),
});
let i = 0;
for await (const message of indexed.readMessages({ validateCrcs: true })) checkMessage(message, i++);
assert.equal(i, count);
// One topic, from the middle: what a viewer asks for.
i = count / 2;
while (i % 3 !== 1) ++i;
const startTime = expectedMessage(i).logTime;
for await (const message of indexed.readMessages({ topics: ["/tick"], startTime })) {
  checkMessage(message, i);
  i += 3;
}
assert.ok(i >= count);
checkRecords(await all(indexed.readAttachments()), expectedAttachments, "attachments by index");
checkRecords(await all(indexed.readMetadata()), expectedMetadata, "metadata by index");
console.log(`${path}: ${count} messages in ${records.Chunk.length} chunks read twice, all CRCs right`);
