// SPDX-License-Identifier: BSD-3-Clause
// node check_rtps.mjs DDS_PEER: lets DDS_PEER publish the telemetry of ../../example_tick.h, receives it with @foxglove/rtps,
// a third implementation of the wire protocol, and decodes it with the message definitions of ROS 2 Humble.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import dgram from "node:dgram";
import rosmsg from "@foxglove/rosmsg-msgs-common";
import serialization from "@foxglove/rosmsg2-serialization";
import rtps from "@foxglove/rtps";
import rtpsNode from "@foxglove/rtps/nodejs";

const definitions = rosmsg.ros2humble;
const domain = 201 + Math.floor(Math.random() * 30);  // the other tests use 100 to 200

// On the loopback interface only.
async function createSocket(options) {
  const socket = new rtpsNode.UdpSocketNode(dgram.createSocket({ type: "udp4", reuseAddr: true, ...options }));
  const { bind, addMembership } = socket;
  socket.addMembership = (address) => addMembership.call(socket, address, "127.0.0.1");
  socket.bind = async (where) => {
    await bind.call(socket, where);
    await socket.setMulticastInterface("127.0.0.1");
  };
  return socket;
}

// A definition and those that it refers to, as the reader wants them: the first one without a name.
function withParts(name) {
  const all = new Map();
  const add = (type) => {
    if (all.has(type)) return;
    all.set(type, definitions[type]);
    for (const field of definitions[type].definitions) if (field.isComplex) add(field.type);
  };
  add(name);
  return [...all].map(([type, d]) => ({ name: type === name ? undefined : type, definitions: d.definitions }));
}

const joints = ["FL", "FR", "RL", "RR"].flatMap((leg) => ["hip", "thigh", "calf"].map((j) => `${leg}_${j}`));
const near = (a, b, what) => assert.ok(Math.abs(a - b) < 1e-9, `${what}: found ${a}, expected ${b}`);
const half = Math.SQRT1_2;
const checks = {
  "rt/joint_states": ["sensor_msgs/JointState", (m) => {
    assert.deepEqual(m.name, joints);
    assert.equal(m.header.frame_id, "base_link");
    const first = m.position[0];
    assert.ok(first > 0.0);
    joints.forEach((_, j) => {
      near(m.position[j], 0.1 * j + first, "position");
      near(m.velocity[j], 1.0 + j, "velocity");
      near(m.effort[j], -2.0 - j, "effort");
    });
  }],
  "rt/imu/data": ["sensor_msgs/Imu", (m) => {
    near(m.orientation.w, half, "w");
    near(m.orientation.z, half, "z");
    assert.deepEqual(m.angular_velocity, { x: 0.1, y: 0.2, z: 0.3 });
    assert.deepEqual(m.linear_acceleration, { x: 0.4, y: 0.5, z: 9.8 });
    assert.equal(m.orientation_covariance.length, 9);
  }],
  "rt/odom": ["nav_msgs/Odometry", (m) => {
    assert.equal(m.header.frame_id, "odom");
    assert.equal(m.child_frame_id, "base_link");
    assert.ok(m.pose.pose.position.y > 0.0);
    assert.ok(m.pose.covariance[35] > 0.0);
    near(m.pose.pose.position.z, 0.45, "z");
    near(m.twist.twist.linear.x, 0.8, "vx");
    near(m.twist.twist.angular.z, 0.3, "yaw rate");
    near(m.twist.covariance[35], 9e-4, "covariance of the yaw rate");
  }],
  "rt/tf": ["tf2_msgs/TFMessage", (m) => {
    assert.equal(m.transforms.length, 3);
    assert.equal(m.transforms[0].child_frame_id, "base_link");
    near(m.transforms[0].transform.rotation.z, half, "z");
  }],
  "rt/diagnostics": ["diagnostic_msgs/DiagnosticArray", (m) => {
    assert.equal(m.status.length, 1);
    assert.equal(m.status[0].name, "sandrunner");
    assert.equal(m.status[0].level, 0);
    assert.deepEqual(m.status[0].values[0], { key: "mode", value: "walk" });
  }],
  "rt/tf_static": ["tf2_msgs/TFMessage", (m) => {
    assert.deepEqual(m.transforms.map((t) => t.child_frame_id), ["trunk", "FL_foot"]);
    near(m.transforms[1].transform.translation.z, -0.4, "z");
  }],
  "rt/robot_description": ["std_msgs/String", (m) => assert.match(m.data, /^<robot\nname="example"/)],
};

const latched = ["rt/robot_description", "rt/tf_static"];

const participant = new rtps.Participant({
  name: "check", addresses: ["127.0.0.1"], domainId: domain, udpSocketCreate: createSocket,
});
const counts = {};
const readers = {};
for (const [topic, [type]] of Object.entries(checks)) {
  counts[topic] = 0;
  readers[topic] = new serialization.MessageReader(withParts(type));
}
let failure;
participant.on("error", (error) => (failure ??= error));
participant.on("userData", ({ publication, serializedData }) => {
  try {
    const topic = publication.topicName;
    checks[topic][1](readers[topic].readMessage(serializedData));
    ++counts[topic];
  } catch (error) {
    failure ??= error;
  }
});
await participant.start();
for (const [topic, [type]] of Object.entries(checks)) {
  const [module, name] = type.split("/");
  participant.subscribe({
    topicName: topic,
    typeName: `${module}::msg::dds_::${name}_`,
    durability: latched.includes(topic) ? rtps.Durability.TransientLocal : rtps.Durability.Volatile,
    reliability: { kind: rtps.Reliability.Reliable, maxBlockingTime: { sec: 0, nsec: 0 } },
    history: { kind: rtps.HistoryKind.KeepLast, depth: 10 },
  });
}

// It must be there first: it expects multicast, and the robot only says once to whom it finds that it is there.
const robot = spawn(process.argv[2], [String(domain), "lo", "publish", "4"], { stdio: ["ignore", "ignore", "inherit"] });
await new Promise((resolve) => robot.on("exit", resolve));
await participant.shutdown();
console.log(JSON.stringify(counts));
if (failure) throw failure;
for (const topic of ["rt/joint_states", "rt/imu/data", "rt/odom", "rt/tf"]) {
  assert.ok(counts[topic] > 200 && counts[topic] <= 400, `messages on ${topic}: found ${counts[topic]}, expected 400`);
}
assert.ok(counts["rt/diagnostics"] >= 2, "diagnostics");
for (const topic of latched) assert.equal(counts[topic], 1, topic);
process.exit(0);
