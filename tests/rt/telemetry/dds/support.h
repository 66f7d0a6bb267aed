// SPDX-License-Identifier: BSD-3-Clause
// A peer in the same process, and a robot that follows the commands.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dds/dds.h"
#include "rt/telemetry/dds/command_inbox.h"
#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/sandrunner.h"
#include "rt/telemetry/dds/telemetry.h"
#include "tests/rt/core/fake_robot.h"
#include "tests/rt/dds/own_domain.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/wait_until.h"

namespace sandrunner {

/// The table [dds] with a domain of its own.
inline DdsConfig test_config() {
  DdsConfig config;
  config.domain = own_domain();
  return config;
}

inline void sleep_s(double duration_s) {
  std::this_thread::sleep_for(std::chrono::duration<double>(duration_s));
}

/// The number after this word, in what a process printed; -1 without.
inline double number_after(const std::string& printed, const std::string& word) {
  const std::string text = "\n" + printed;
  const std::size_t at = text.find(word + " ");
  return at == std::string::npos ? -1.0 : std::stod(text.substr(at + word.size()));
}

/// Another participant in the same process and domain, with its own QoS.
class Peer {
 public:
  explicit Peer(const DdsConfig& config)
      : participant_(
            dds_create_participant(static_cast<dds_domainid_t>(config.domain), nullptr, nullptr)) {}
  ~Peer() { dds_delete(participant_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  dds_entity_t reader(const char* topic, const dds_topic_descriptor_t& type, bool latched = false) {
    return dds_create_reader(participant_, make_topic(topic, type), qos(latched).get(), nullptr);
  }
  /// Returns once it has found `readers` readers.
  dds_entity_t writer(const char* topic, const dds_topic_descriptor_t& type,
                      std::uint32_t readers = 1) {
    const dds_entity_t writer =
        dds_create_writer(participant_, make_topic(topic, type), qos(false).get(), nullptr);
    wait_until([&] {
      dds_publication_matched_status_t status;
      dds_get_publication_matched_status(writer, &status);
      return status.current_count >= readers;
    });
    return writer;
  }

 private:
  struct QosDeleter {
    void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
  };
  using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;
  static Qos qos(bool latched) {
    Qos q(dds_create_qos());
    dds_qset_reliability(q.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(q.get(), DDS_HISTORY_KEEP_LAST, 1000);
    if (latched) dds_qset_durability(q.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    return q;
  }
  dds_entity_t make_topic(const char* name, const dds_topic_descriptor_t& type) {
    return dds_create_topic(participant_, &type, name, nullptr, nullptr);
  }

  dds_entity_t participant_;
};

/// Takes all messages that have arrived; `use` is given each. Returns how many there were.
template <typename Message>
long long take(dds_entity_t reader, const std::function<void(const Message&)>& use) {
  return take(reader, [&](const void* message, const dds_sample_info_t&) {
    use(*static_cast<const Message*>(message));
  });
}

/// Writes a Twist with this forward velocity.
inline void drive(dds_entity_t writer, double vx_mps) {
  geometry_msgs_msg_dds__Twist_ twist{};
  twist.linear.x = vx_mps;
  dds_write(writer, &twist);
}

/// Publishes example ticks at the control loop's rate, from `first_tick` on; returns the longest
/// time that one add() took, s.
inline double publish_for(Telemetry& telemetry, std::uint64_t first_tick, double duration_s) {
  using Steady = std::chrono::steady_clock;
  if (first_tick == 0) telemetry.begin(kExampleStart_ns);
  const auto start = Steady::now();
  const std::uint64_t ticks = ticks_from_s(duration_s);
  double longest_s = 0.0;
  for (std::uint64_t done = 0; done < ticks;) {
    const std::chrono::duration<double> time = Steady::now() - start;
    for (const std::uint64_t due = std::min(ticks, ticks_from_s(time.count())); done < due;
         ++done) {
      const auto before = Steady::now();
      telemetry.add(example_tick(first_tick + done));
      longest_s =
          std::max(longest_s, std::chrono::duration<double>(Steady::now() - before).count());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return longest_s;
}

/// A robot that follows a RemoteOperator at 4 kHz in real time, in a thread of its own.
class LiveRobot {
 public:
  LiveRobot(RemoteOperator& op, const DdsConfig& config) : operator_(op) {
    controller_.shaping.operator_hold_ticks = config.stale_ticks();
    controller_.stand.fold_s = controller_.stand.extend_s = 0.05;  // stands up quickly
    controller_.stand.max_speed_radps = 20.0;
    loop_ = std::make_unique<FakeLoop>(Mode::kPassive, controller_);
    thread_ = std::thread([this] { run(); });
  }
  ~LiveRobot() {
    end_ = true;
    thread_.join();
  }

  std::uint64_t ticks() const { return ticks_; }  ///< done
  Mode mode() const { return mode_; }
  double speed_mps() const { return speed_mps_; }  ///< the policy is asked for
  /// Waits for two more ticks: what was set before has then had its effect.
  bool go_on() const {
    const std::uint64_t end = ticks_ + 2;
    return wait_until([&] { return ticks_ >= end; });
  }
  void break_joint() { broken_ = true; }  ///< until mend_joint(): a measured NaN
  void mend_joint() { broken_ = false; }

 private:
  void run() {
    loop_->spoil = [this](ControllerInput& input) {
      if (broken_) input.sensors.joints.position_rad[0] = NAN;
    };
    const auto start = std::chrono::steady_clock::now();
    std::uint64_t tick = 0;
    while (!end_) {
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
      for (const std::uint64_t due = ticks_from_s(time.count()); tick < due; ++tick) {
        loop_->input.command = operator_.command(tick);
        loop_->tick();
        operator_.advance({.mode = loop_->output.mode, .faults = loop_->output.faults});
        mode_ = loop_->output.mode;
        speed_mps_ = loop_->output.policy_input.command.vx_mps;
        ticks_ = tick + 1;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  RemoteOperator& operator_;
  ControllerConfig controller_ = test_robot();
  std::unique_ptr<FakeLoop> loop_;
  std::atomic<bool> end_{false}, broken_{false};
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<Mode> mode_{Mode::kPassive};
  std::atomic<double> speed_mps_{0.0};
  std::thread thread_;
};

/// The robot's whole side of the commands.
struct LiveSetup {
  explicit LiveSetup(const DdsConfig& config_in = test_config(), const char* no_walk = nullptr)
      : config(config_in),
        participant(config),
        op(config.stale_ticks()),
        desk(op, config.stale_s, no_walk, std::chrono::seconds(5)),
        inbox(participant, config, "example@here", desk),
        robot(op, config) {}

  DdsConfig config;
  DdsParticipant participant;
  RemoteOperator op;
  OperatorDesk desk;
  CommandInbox inbox;
  LiveRobot robot;
};

/// An operator in the same process that sends mode requests and waits for the replies.
class Asker {
 public:
  explicit Asker(Peer& peer)
      : replies_(peer.reader("sandrunner/mode_reply", sandrunner_ModeReply_desc)),
        requests_(peer.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc)) {}

  /// Returns the reply; if none came, one with the reason "no reply".
  sandrunner_ModeReply ask(const std::string& request) {
    sandrunner_ModeRequest message{};
    message.id = ++id_;
    request.copy(message.request, sizeof message.request - 1);
    dds_write(requests_, &message);
    sandrunner_ModeReply reply{};
    std::string("no reply").copy(reply.reason, sizeof reply.reason - 1);
    wait_until(
        [&] {
          bool came = false;
          take<sandrunner_ModeReply>(replies_, [&](const sandrunner_ModeReply& r) {
            if (r.id != id_) return;
            came = true;
            reply = r;
          });
          return came;
        },
        10);
    return reply;
  }

 private:
  dds_entity_t replies_, requests_;
  std::uint64_t id_ = 1000;
};

}  // namespace sandrunner
