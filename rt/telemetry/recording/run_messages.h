// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "estimator/odometry.h"
#include "rt/core/robot_description.h"
#include "rt/core/slower_rate.h"
#include "rt/loop/tick_record.h"
#include "rt/telemetry/diagnostics.h"
#include "rt/telemetry/recording/cdr.h"

namespace sandrunner {

/// Ticks in a message of `kTicks`, and in a batch that the recorder takes.
inline constexpr std::size_t kTicksPerMessage = 40;

/// The topics of a run, in the order in which a recording has them.
enum class RunTopic : std::uint8_t {
  kTicks,
  kStates,  ///< in recordings only
  kEvents,
  kJointStates,
  kImu,
  kOdometry,
  kTransforms,
  kDiagnostics,
  kRobotDescription,
  kFixedTransforms,
};
inline constexpr std::size_t kNumRunTopics = 10;
using RunTopics = std::bitset<kNumRunTopics>;  ///< by index_of
constexpr std::size_t index_of(RunTopic topic) noexcept { return static_cast<std::size_t>(topic); }

struct RunTopicInfo {
  const char* name;             ///< "/joint_states"
  const char* schema;           ///< "sensor_msgs/msg/JointState"
  const char* schema_encoding;  ///< "ros2msg", or "omgidl" for our own
  std::string schema_text;      ///< its definition and those of its parts
  /// Has one message, before all others: in ROS 2, readers that come later get it too.
  bool once = false;
};

/// By RunTopic. Messages of all are CDR.
const std::array<RunTopicInfo, kNumRunTopics>& run_topics();

inline constexpr const char* kTicksTopic = "/sandrunner/ticks";
inline constexpr const char* kStatesTopic = "/sandrunner/states";
inline constexpr const char* kEventsTopic = "/sandrunner/events";

/// Turns the ticks of a run into the messages of its topics: ticks as they are, events and, for the
/// usual tools, ROS 2 topics at the rate of the policy, diagnostics once a second.
class RunMessages {
 public:
  struct Message {
    RunTopic topic;
    std::uint64_t sequence;  ///< of its topic
    std::uint64_t time_ns;   ///< of its tick, since 1970
    const CdrWriter& content;
  };
  using Sink = std::function<void(const Message&)>;

  /// `start_time_ns`: wall clock at tick 0, since 1970. `first_tick` of those that are added.
  RunMessages(const RobotDescription& robot, std::int64_t start_time_ns, std::uint64_t first_tick,
              Sink sink);

  /// The messages of topics that have `once`. Call it first.
  void begin();
  /// Up to kTicksPerMessage ticks, in order, as a message of `kTicks`.
  void add_batch(std::span<const TickRecord> ticks);
  /// The next tick's messages of all other topics.
  void add(const TickRecord& tick);
  /// What an operator did before `tick` to the robot or its ground.
  void add_event(std::uint64_t tick, const std::string& kind, const std::string& text);
  /// The state before tick `next_tick`: a message of `kStates`.
  void add_state(std::uint64_t next_tick, const std::string& state);
  /// From now on only these topics' messages are made; all, if this is not called.
  void want(const RunTopics& topics) noexcept { wanted_ = topics; }

  std::uint64_t time_ns(std::uint64_t tick) const noexcept {
    return static_cast<std::uint64_t>(start_time_ns_) + tick * kControlPeriod_ns;
  }

 private:
  bool wants(RunTopic topic) const noexcept { return wanted_[index_of(topic)]; }
  void add_events(const TickRecord& tick);
  // `content()`: a CdrWriter; made only if the topic is wanted.
  template <typename Content>
  void say(RunTopic topic, std::uint64_t sequence, std::uint64_t tick, const Content& content);

  const RobotDescription robot_;
  const std::int64_t start_time_ns_;
  const std::uint64_t first_tick_;
  const Sink sink_;
  RunTopics wanted_ = RunTopics().set();
  Odometry odometry_;
  Diagnostics diagnostics_;
  SlowerRate policy_rate_{kPolicyHz}, diagnostics_rate_{1};
  std::uint64_t batches_ = 0, states_ = 0, events_ = 0;
  bool has_last_ = false;
  std::uint64_t last_mode_ = 0, last_faults_ = 0, last_warnings_ = 0, last_request_ = 0;
};

}  // namespace sandrunner
