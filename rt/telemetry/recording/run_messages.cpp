// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/run_messages.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "rt/core/mode_machine.h"
#include "rt/loop/tick_fields.h"
#include "rt/telemetry/recording/ros_cdr.h"

namespace sandrunner {
namespace {

constexpr const char* kStateIdl =
    "module sandrunner {\n  struct ReplayState {\n    sequence<octet> bytes;\n  };\n};\n";
constexpr const char* kEventIdl =
    "module sandrunner {\n  struct Event {\n    unsigned long long tick;\n    string kind;\n"
    "    string text;\n  };\n};\n";

const std::string kRule(80, '=');

/// A definition followed by those of its parts, as `ros2msg` requires.
std::string with_parts(std::string text, const std::vector<std::array<const char*, 2>>& parts) {
  for (const auto& [name, definition] : parts) {
    text += kRule + "\nMSG: " + name + "\n" + definition;
  }
  return text;
}

constexpr const char* kTime = "int32 sec\nuint32 nanosec\n";
constexpr const char* kHeader = "builtin_interfaces/Time stamp\nstring frame_id\n";
constexpr const char* kVector3 = "float64 x\nfloat64 y\nfloat64 z\n";
constexpr const char* kQuaternion = "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";

}  // namespace

const std::array<RunTopicInfo, kNumRunTopics>& run_topics() {
  static const std::string transforms =
      with_parts("geometry_msgs/TransformStamped[] transforms\n",
                 {{"geometry_msgs/TransformStamped",
                   "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"},
                  {"std_msgs/Header", kHeader},
                  {"builtin_interfaces/Time", kTime},
                  {"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"},
                  {"geometry_msgs/Vector3", kVector3},
                  {"geometry_msgs/Quaternion", kQuaternion}});
  static const std::array<RunTopicInfo, kNumRunTopics> topics = {{
      {kTicksTopic, "sandrunner::TickRecordBatch", "omgidl", tick_idl()},
      {kStatesTopic, "sandrunner::ReplayState", "omgidl", kStateIdl},
      {kEventsTopic, "sandrunner::Event", "omgidl", kEventIdl},
      {"/joint_states", "sensor_msgs/msg/JointState", "ros2msg",
       with_parts("std_msgs/Header header\nstring[] name\nfloat64[] position\n"
                  "float64[] velocity\nfloat64[] effort\n",
                  {{"std_msgs/Header", kHeader}, {"builtin_interfaces/Time", kTime}})},
      {"/imu/data", "sensor_msgs/msg/Imu", "ros2msg",
       with_parts("std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
                  "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
                  "float64[9] angular_velocity_covariance\n"
                  "geometry_msgs/Vector3 linear_acceleration\n"
                  "float64[9] linear_acceleration_covariance\n",
                  {{"std_msgs/Header", kHeader},
                   {"builtin_interfaces/Time", kTime},
                   {"geometry_msgs/Quaternion", kQuaternion},
                   {"geometry_msgs/Vector3", kVector3}})},
      {"/odom", "nav_msgs/msg/Odometry", "ros2msg",
       with_parts("std_msgs/Header header\nstring child_frame_id\n"
                  "geometry_msgs/PoseWithCovariance pose\n"
                  "geometry_msgs/TwistWithCovariance twist\n",
                  {{"std_msgs/Header", kHeader},
                   {"builtin_interfaces/Time", kTime},
                   {"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n"},
                   {"geometry_msgs/Pose", "Point position\nQuaternion orientation\n"},
                   {"geometry_msgs/Point", kVector3},
                   {"geometry_msgs/Quaternion", kQuaternion},
                   {"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n"},
                   {"geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n"},
                   {"geometry_msgs/Vector3", kVector3}})},
      {"/tf", "tf2_msgs/msg/TFMessage", "ros2msg", transforms},
      {"/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", "ros2msg",
       with_parts("std_msgs/Header header\nDiagnosticStatus[] status\n",
                  {{"std_msgs/Header", kHeader},
                   {"builtin_interfaces/Time", kTime},
                   {"diagnostic_msgs/DiagnosticStatus",
                    "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\n"
                    "string name\nstring message\nstring hardware_id\nKeyValue[] values\n"},
                   {"diagnostic_msgs/KeyValue", "string key\nstring value\n"}})},
      {"/robot_description", "std_msgs/msg/String", "ros2msg", "string data\n", true},
      {"/tf_static", "tf2_msgs/msg/TFMessage", "ros2msg", transforms, true},
  }};
  return topics;
}

RunMessages::RunMessages(const RobotDescription& robot, std::int64_t start_time_ns,
                         std::uint64_t first_tick, Sink sink)
    : robot_(robot),
      start_time_ns_(start_time_ns),
      first_tick_(first_tick),
      sink_(std::move(sink)),
      odometry_(robot),
      diagnostics_(robot) {}

template <typename Content>
void RunMessages::say(RunTopic topic, std::uint64_t sequence, std::uint64_t tick,
                      const Content& content) {
  if (wants(topic)) sink_({topic, sequence, time_ns(tick), content()});
}

void RunMessages::begin() {
  say(RunTopic::kRobotDescription, 1, first_tick_, [&] { return cdr(robot_.ros_urdf); });
  say(RunTopic::kFixedTransforms, 1, first_tick_, [&] {
    return cdr(fixed_transforms(robot_, static_cast<std::int64_t>(time_ns(first_tick_))));
  });
}

void RunMessages::add_batch(std::span<const TickRecord> ticks) {
  ++batches_;
  say(RunTopic::kTicks, batches_, ticks.front().input.sensors.tick, [&] {
    CdrWriter out;
    out.number(batches_).number(static_cast<std::uint32_t>(ticks.size()));
    return std::move(out.block(std::as_bytes(ticks), 8));
  });
}

void RunMessages::add(const TickRecord& tick) {
  odometry_.add(tick.input, tick.output);
  diagnostics_.add(tick);
  add_events(tick);
  const std::uint64_t number = tick.input.sensors.tick;
  if (!policy_rate_.due(number)) return;
  const auto now = static_cast<std::int64_t>(time_ns(number));
  const std::uint64_t sequence = number / kTicksPerPolicyStep;
  say(RunTopic::kJointStates, sequence, number,
      [&] { return cdr(joint_state_message(tick, robot_, now)); });
  say(RunTopic::kImu, sequence, number, [&] { return cdr(imu_message(tick, robot_, now)); });
  say(RunTopic::kOdometry, sequence, number,
      [&] { return cdr(odometry_message(odometry_, robot_, now)); });
  say(RunTopic::kTransforms, sequence, number,
      [&] { return cdr(moving_transforms(tick, odometry_, robot_, now)); });
  if (!diagnostics_rate_.due(number)) return;
  say(RunTopic::kDiagnostics, number / kControlHz, number,
      [&] { return cdr(diagnostics_.message(now)); });
}

void RunMessages::add_event(std::uint64_t tick, const std::string& kind, const std::string& text) {
  say(RunTopic::kEvents, ++events_, tick, [&] {
    CdrWriter out;
    return std::move(out.number(tick).text(kind).text(text));
  });
}

void RunMessages::add_state(std::uint64_t next_tick, const std::string& state) {
  say(RunTopic::kStates, ++states_, next_tick, [&] {
    CdrWriter out;
    out.number(static_cast<std::uint32_t>(state.size()));
    return std::move(out.block(std::as_bytes(std::span(state)), 1));
  });
}

void RunMessages::add_events(const TickRecord& tick) {
  const auto event = [&](const char* kind, const std::string& text) {
    add_event(tick.input.sensors.tick, kind, text);
  };
  const auto mode = static_cast<std::uint64_t>(tick.output.mode);
  const std::uint64_t request = tick.input.command.request_id;
  if (!has_last_ && first_tick_ > 0) last_request_ = request;
  if (!has_last_ || mode != last_mode_) event("mode", mode_name(tick.output.mode));
  if (request != last_request_) {
    const RequestRow* const row = row_of(tick.input.command.request);
    event("request", row ? row->name : "none");
  }
  for (int bit = 0; bit < kNumFaults; ++bit) {
    const std::uint64_t mask = std::uint64_t{1} << bit;
    if ((tick.output.faults & mask) != 0 && (last_faults_ & mask) == 0) {
      event("fault", fault_name(static_cast<Fault>(mask)));
    }
  }
  if (tick.output.warnings != 0 && last_warnings_ == 0) {
    event("warning", warning_name(tick.output.warnings));
  }
  if (tick.skipped > 0) event("skipped", fmt::format("{} ticks", tick.skipped));
  has_last_ = true;
  last_mode_ = mode;
  last_faults_ = tick.output.faults;
  last_warnings_ = tick.output.warnings;
  last_request_ = request;
}

}  // namespace sandrunner
