// SPDX-License-Identifier: BSD-3-Clause
// node check_foxglove.mjs SANDRUNNER FOLDER: looks at a run of SANDRUNNER --view with Foxglove's own client and compares
// what it gets with what the run records in FOLDER.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import fs from "node:fs";
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader as IdlReader } from "@foxglove/omgidl-serialization";
import { parse as parseRos } from "@foxglove/rosmsg";
import { MessageReader as RosReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import { WebSocket } from "ws";
import { readStream } from "./mcap_file.mjs";

const [sandrunner, folder] = process.argv.slice(2);

function readerOf(name, encoding, text) {
  return encoding === "omgidl" ? new IdlReader(name, parseIDL(text)) : new RosReader(parseRos(text, { ros2: true }));
}

/** Foxglove at `port`: the topics it was offered, and the messages that it has got. */
function connect(port, subprotocol) {
  const client = new protocol.FoxgloveClient({ ws: new WebSocket(`ws://127.0.0.1:${port}`, [subprotocol]) });
  const seen = { client, subscriptions: new Map(), messages: [], statuses: [], time: 0n };
  client.on("error", (error) => assert.fail(error));
  client.on("serverInfo", (info) => assert.deepEqual(info.capabilities, ["time"]));
  client.on("status", (status) => seen.statuses.push(status));
  client.on("time", ({ timestamp }) => {
    assert.ok(timestamp > seen.time, "time goes on");
    seen.time = timestamp;
  });
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    const { channel, reader } = seen.subscriptions.get(subscriptionId);
    assert.ok(timestamp <= seen.time, "its time comes first");
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    seen.messages.push({ topic: channel.topic, timestamp, bytes, value: reader.readMessage(bytes) });
  });
  seen.subscribe = (topic) => {
    const channel = seen.channels.get(topic);
    const reader = readerOf(channel.schemaName, channel.schemaEncoding, channel.schema);
    const id = client.subscribe(channel.id);
    seen.subscriptions.set(id, { channel, reader });
    return id;
  };
  return new Promise((resolve) => {
    client.on("advertise", (channels) => {
      seen.channels = new Map(channels.map((channel) => [channel.topic, channel]));
      resolve(seen);
    });
  });
}

const refusal = (port, subprotocols, options) =>
  new Promise((resolve) => {
    const socket = new WebSocket(`ws://127.0.0.1:${port}`, subprotocols, options);
    socket.on("unexpected-response", (_, response) => resolve(response.statusCode));
    socket.on("open", () => resolve("open"));
  });
const seconds = (s) => new Promise((resolve) => setTimeout(resolve, 1000 * s));

const run = spawn(sandrunner, ["--view", "--set", "view.port=0", "--duration", "1", "--record", folder], { stdio: ["ignore", "pipe", "pipe"] });
process.on("exit", () => run.kill("SIGKILL"));
let [said, port] = ["", undefined];
const ended = new Promise((resolve) => run.stdout.on("data", (text) => /wrote|state hash/.test((said += text)) && resolve()));
await new Promise((resolve) => run.stderr.on("data", (text) => (port ??= /127\.0\.0\.1:(\d+)/.exec(text)?.[1]) && resolve()));

const all = await connect(port, "foxglove.sdk.v1");
for (const topic of all.channels.keys()) all.subscribe(topic);
assert.equal(await refusal(port, ["foxglove.sdk.v1"], { origin: "https://evil.example" }), 403);
assert.equal(await refusal(port, ["mqtt"]), 404);
const one = await connect(port, "foxglove.websocket.v1");
const imu = one.subscribe("/imu/data");
one.client.getParameters([]);
await seconds(1);
one.client.unsubscribe(imu);
await seconds(0.5);
const before = one.messages.length;
assert.ok(before > 20, `${before} messages in a second`);
await ended;
await seconds(0.2);
assert.equal(one.messages.length, before, "nothing comes without a subscription");
assert.equal(one.statuses.length, 1, "a page of Foxglove only looks");
assert.deepEqual(all.statuses, []);
const ending = new Promise((resolve) => run.on("exit", resolve));
run.kill("SIGINT");
assert.equal(await ending, 0);

// The recording, by topic and time; of the ticks, by their number.
const recorded = [];
const records = readStream(new Uint8Array(fs.readFileSync(`${folder}/run.mcap`)), (message) => recorded.push(message));
const schemas = new Map(records.Schema.map((schema) => [schema.id, schema]));
const channels = new Map(records.Channel.map((channel) => [channel.id, channel]));
const readers = new Map(
  records.Channel.map(({ id, schemaId }) => {
    const { name, encoding, data } = schemas.get(schemaId);
    return [id, readerOf(name, encoding, new TextDecoder().decode(data))];
  }),
);
const kTicks = "/sandrunner/ticks";
const [values, ticks] = [new Map(), new Map()];
for (const { channelId, logTime, data } of recorded) {
  const topic = channels.get(channelId).topic;
  const value = readers.get(channelId).readMessage(data);
  if (topic === kTicks) for (const tick of value.ticks) ticks.set(tick.tick, tick);
  const key = `${topic} ${logTime}`;
  values.set(key, [...(values.get(key) ?? []), { value, bytes: Buffer.from(data) }]);
}
const counts = {};
for (const { topic, timestamp, bytes, value } of all.messages) {
  counts[topic] = (counts[topic] ?? 0) + 1;
  if (topic === kTicks) {
    for (const tick of value.ticks) assert.deepEqual(tick, ticks.get(tick.tick));
    continue;
  }
  const same = values.get(`${topic} ${timestamp}`)?.find((message) => message.bytes.equals(bytes));
  assert.ok(same, `${topic} at ${timestamp} is in the recording`);
  assert.deepEqual(value, same.value);
}
const least = { [kTicks]: 400, "/sandrunner/events": 3, "/joint_states": 400, "/imu/data": 400, "/odom": 400, "/tf": 400, "/diagnostics": 4 };
for (const [topic, count] of Object.entries(least)) assert.ok(counts[topic] >= count, `${topic}: ${counts[topic]} messages`);
for (const topic of ["/tf_static", "/robot_description"]) assert.equal(counts[topic], 1, topic);
console.log(`${all.messages.length} messages of ${Object.keys(counts).length} topics, each as recorded`);
process.exit();
