// SPDX-License-Identifier: BSD-3-Clause
// node check_recording.mjs FILE TICKS: reads what `sandrunner --record` wrote of a run of TICKS ticks in lockstep with
// @mcap/core, once as a stream and once through its indexes, all of it.
import assert from "node:assert/strict";
import fs from "node:fs";
import { all, openIndexed, readStream } from "./mcap_file.mjs";

const [path, ticks] = [process.argv[2], Number(process.argv[3])];
const bytes = new Uint8Array(fs.readFileSync(path));

// Topic, schema and number of messages of it; undefined: at least one (a state per chunk, that the robot walks).
const batches = Math.ceil(ticks / 40);
const expectedTopics = {
  "/sandrunner/ticks": ["sandrunner::TickRecordBatch", "omgidl", batches],
  "/sandrunner/states": ["sandrunner::ReplayState", "omgidl", undefined],
  "/sandrunner/events": ["sandrunner::Event", "omgidl", undefined],
  "/joint_states": ["sensor_msgs/msg/JointState", "ros2msg", batches],
  "/imu/data": ["sensor_msgs/msg/Imu", "ros2msg", batches],
  "/odom": ["nav_msgs/msg/Odometry", "ros2msg", batches],
  "/tf": ["tf2_msgs/msg/TFMessage", "ros2msg", batches],
  "/tf_static": ["tf2_msgs/msg/TFMessage", "ros2msg", 1],
  "/robot_description": ["std_msgs/msg/String", "ros2msg", 1],
  "/diagnostics": ["diagnostic_msgs/msg/DiagnosticArray", "ros2msg", Math.ceil(ticks / 4000)],
};

// 64-bit words of a tick by the schema that the file brings along.
function wordsOfTick(idl) {
  const fields = idl.split("struct TickRecord {")[1].split("}")[0].trim().split("\n");
  return fields.reduce((sum, field) => {
    const match = /^\s*(?:double|(?:unsigned )?long long) \w+(?:\[(\d+)\])?;$/.exec(field);
    assert.ok(match, field);
    return sum + Number(match[1] ?? 1);
  }, 0);
}

const messages = [];
const records = readStream(bytes, (message) => messages.push(message));
assert.ok(records.Chunk.length >= 2, "several chunks");
const schemas = new Map(records.Schema.map((schema) => [schema.id, schema]));
const channels = new Map(records.Channel.map((channel) => [channel.id, channel]));
assert.deepEqual([...channels.values()].map((c) => c.topic).sort(), Object.keys(expectedTopics).sort());
for (const [id, { topic, schemaId, messageEncoding }] of channels) {
  const [name, encoding, count] = expectedTopics[topic];
  assert.equal(schemas.get(schemaId).name, name);
  assert.equal(schemas.get(schemaId).encoding, encoding);
  assert.ok(schemas.get(schemaId).data.length > 0);
  assert.equal(messageEncoding, "cdr");
  const found = messages.filter((message) => message.channelId === id).length;
  if (count === undefined) assert.ok(found > 0, topic);
  else assert.equal(found, count, topic);
}

// Every tick, in order.
const ticksChannel = [...channels.values()].find((channel) => channel.topic === "/sandrunner/ticks");
const words = wordsOfTick(new TextDecoder().decode(schemas.get(ticksChannel.schemaId).data));
let [next, sequence] = [0n, undefined];
for (const { channelId, data } of messages) {
  if (channelId !== ticksChannel.id) continue;
  const view = new DataView(data.buffer, data.byteOffset + 4, data.byteLength - 4);  // behind the CDR header
  if (sequence !== undefined) assert.equal(view.getBigUint64(0, true), sequence + 1n);
  sequence = view.getBigUint64(0, true);
  const count = view.getUint32(8, true);
  assert.equal(view.byteLength, 16 + 8 * words * count);
  for (let i = 0; i < count; ++i) assert.equal(view.getBigUint64(16 + 8 * words * i, true), next++);
}
assert.equal(next, BigInt(ticks));

const attachments = new Map(records.Attachment.map((a) => [a.name, new TextDecoder().decode(a.data)]));
assert.deepEqual([...attachments.keys()].sort(), ["config.toml", "policy.safetensors", "robot.toml", "robot.urdf"]);
assert.match(attachments.get("config.toml"), /friction/);
assert.match(attachments.get("policy.safetensors"), /F32/);
assert.match(attachments.get("robot.toml"), /urdf = /);
assert.match(attachments.get("robot.urdf"), /<robot/);
const run = records.Metadata.find((m) => m.name === "run").metadata;
assert.equal(run.get("clock"), "lockstep");
assert.ok(run.get("build"));

const indexed = await openIndexed(bytes);
assert.equal(indexed.statistics.messageCount, BigInt(messages.length));
assert.equal(indexed.chunkIndexes.length, records.Chunk.length);
assert.equal((await all(indexed.readMessages({ validateCrcs: true }))).length, messages.length);
assert.equal((await all(indexed.readAttachments())).length, attachments.size);
console.log(`${path}: ${ticks} ticks, ${messages.length} messages in ${records.Chunk.length} chunks read twice, all CRCs right`);
