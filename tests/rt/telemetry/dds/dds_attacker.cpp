// SPDX-License-Identifier: BSD-3-Clause
// Strangers on DDS, for tools/attack:
//   dds_attacker DOMAIN SEED SECONDS TORQUE_NM FORWARD_MPS BACKWARD_MPS LATERAL_MPS YAW_RADPS
// Waits for a robot on "lo", then for SECONDS sends it velocities, requests, calls and packets,
// proper and broken ones. Operators come and go, and sometimes another robot. Every tick that the
// robot publishes is held against its bounds: what it may ask of a joint, what of the policy.
// 0: none was broken, or nobody was there; 3: one was, which is the one line on standard error.
#include <arpa/inet.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "rt/core/messages.h"
#include "rt/core/mode_machine.h"
#include "rt/dds/participant.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/sandrunner.h"

namespace sandrunner {
namespace {

using Steady = std::chrono::steady_clock;

/// What holds for every tick of a robot that nothing is wrong with.
struct Bounds {
  double torque_nm, forward_mps, backward_mps, lateral_mps, yaw_radps;
  static constexpr double kKp_nmprad = 200.0, kKd_nmsprad = 4.0;  // robot file, [gains]

  /// Which one is broken; null: none. Ticks are rounded to single precision.
  const char* broken(const sandrunner_TickState& tick) const {
    constexpr double kRounding = 1e-3;
    if (tick.mode > static_cast<std::uint32_t>(Mode::kFault)) return "mode";
    const auto mode = static_cast<Mode>(tick.mode);
    const bool limp = mode == Mode::kPassive || mode == Mode::kDamping || mode == Mode::kFault;
    for (int j = 0; j < kNumJoints; ++j) {
      const double kp = tick.kp_nmprad[j], kd = tick.kd_nmsprad[j];
      if (!(kp >= 0.0 && kp <= kKp_nmprad && kd >= 0.0 && kd <= kKd_nmsprad)) return "gains";
      if ((limp || tick.faults != 0) && kp != 0.0) return "stiffness";
      const double nm = kp * (tick.target_rad[j] - static_cast<double>(tick.position_rad[j])) -
                        kd * tick.velocity_radps[j];
      if (!(std::fabs(nm) <= torque_nm + kRounding)) return "torque";
    }
    const float* const v = tick.command;
    if (!(v[0] <= forward_mps + kRounding && v[0] >= -backward_mps - kRounding)) return "vx";
    if (!(std::fabs(v[1]) <= lateral_mps + kRounding)) return "vy";
    return std::fabs(v[2]) <= yaw_radps + kRounding ? nullptr : "wz";
  }
};

/// A participant that obeys no rule.
class Stranger {
 public:
  explicit Stranger(int domain)
      : participant_(
            dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr)) {}
  ~Stranger() { dds_delete(participant_); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  /// `type` says how `message` is laid out, `called` what it is said to be.
  void send(const char* topic, const dds_topic_descriptor_t& type, const char* called,
            const void* message) {
    const dds_topic_descriptor_t lie{.m_size = type.m_size,
                                     .m_align = type.m_align,
                                     .m_flagset = type.m_flagset,
                                     .m_nkeys = type.m_nkeys,
                                     .m_typename = called,
                                     .m_keys = type.m_keys,
                                     .m_nops = type.m_nops,
                                     .m_ops = type.m_ops,
                                     .m_meta = type.m_meta,
                                     .type_information = {},
                                     .type_mapping = {},
                                     .restrict_data_representation = 0};
    const dds_entity_t made = dds_create_topic(participant_, &lie, topic, nullptr, nullptr);
    const dds_entity_t writer = dds_create_writer(participant_, made, nullptr, nullptr);
    for (int wait = 0; wait < 20 && !found(writer); ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    dds_write(writer, message);
  }

  /// The robot's ticks, and those of nobody in this process.
  dds_entity_t ticks() {
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1000);
    dds_qset_ignorelocal(qos, DDS_IGNORELOCAL_PROCESS);
    const dds_entity_t topic = dds_create_topic(participant_, &sandrunner_TickBatch_desc,
                                                "sandrunner/ticks", nullptr, nullptr);
    const dds_entity_t reader = dds_create_reader(participant_, topic, qos, nullptr);
    dds_delete_qos(qos);
    return reader;
  }

 private:
  static bool found(dds_entity_t writer) {
    dds_publication_matched_status_t status;
    return dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK &&
           status.current_count > 0;
  }

  dds_entity_t participant_;
};

class Attacker {
 public:
  Attacker(int domain, unsigned seed)
      : domain_(domain),
        random_(seed),
        participant_(config(domain), "operator"),
        velocities_(participant_.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc, 1)),
        requests_(participant_.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc, 32)),
        texts_(participant_.writer("rt/sandrunner/request", std_msgs_msg_dds__String__desc, 32)) {
    for (const RequestRow& row : kRequestTable) {
      const std::string topic = "rq/sandrunner/" + std::string(row.name) + "Request";
      services_.push_back(
          participant_.writer(topic.c_str(), std_srvs_srv_dds__Trigger_Request__desc, 10));
    }
    impostor_ = pick(20) == 0;
  }

  int domain() const { return domain_; }

  void strike() {
    const int what = pick(100);
    if (what < 40) {
      request();
    } else if (what < 70) {
      velocity();
    } else if (what < 78) {
      call();
    } else if (what < 84) {
      std_msgs_msg_dds__String_ message{text().data()};
      dds_write(texts_, &message);
    } else if (what < 93) {
      packet();
    } else {
      stranger();
    }
    std::this_thread::sleep_for(std::chrono::microseconds(pick(4000)));
  }

 private:
  static DdsConfig config(int domain) {
    DdsConfig config;
    config.domain = domain;
    return config;
  }

  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }

  double value() {
    constexpr std::array kOdd = {std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity(),
                                 1e308,
                                 -1e308,
                                 5e-324,
                                 -0.0,
                                 0.0,
                                 5.0,
                                 -5.0,
                                 5.0000001,
                                 10.0};
    if (pick(4) == 0) return kOdd[static_cast<std::size_t>(pick(kOdd.size()))];
    return std::uniform_real_distribution(-6.0, 6.0)(random_);
  }

  /// A request that a robot knows, more often than not one that gets it going, or any bytes.
  std::string& text() {
    constexpr std::array kUseful = {"arm", "stand", "walk"};
    const int what = pick(20);
    text_.clear();
    if (what < 14) {
      text_ = kUseful[static_cast<std::size_t>(pick(3))];
    } else if (what < 18) {
      text_ = kRequestTable[static_cast<std::size_t>(pick(static_cast<int>(kRequestTable.size())))]
                  .name;
    } else {
      for (int i = pick(8) == 0 ? 60000 : pick(20); i > 0; --i) {
        text_ += static_cast<char>(1 + pick(255));
      }
    }
    return text_;
  }

  geometry_msgs_msg_dds__Twist_ twist() {
    return {{value(), value(), value()}, {value(), value(), value()}};
  }

  void velocity() {
    geometry_msgs_msg_dds__Twist_ message = twist();
    if (pick(3) != 0) {  // one that is taken
      message = {{std::uniform_real_distribution(-5.0, 5.0)(random_), 0.0, 0.0}, {}};
    }
    for (int i = pick(8) == 0 ? 500 : 1; i > 0; --i) dds_write(velocities_, &message);
  }

  void request() {
    sandrunner_ModeRequest message{};
    message.id = random_();
    text().copy(message.request, sizeof message.request - 1);
    for (int i = pick(10) == 0 ? 50 : 1; i > 0; --i) dds_write(requests_, &message);
  }

  void call() {
    std_srvs_srv_dds__Trigger_Request_ message{random_(), static_cast<std::int64_t>(random_()),
                                               byte()};
    dds_write(services_[static_cast<std::size_t>(pick(static_cast<int>(services_.size())))],
              &message);
  }

  /// A participant that comes, sends one message and goes.
  void stranger() {
    Stranger one(domain_);
    geometry_msgs_msg_dds__TwistStamped_ stamped{};
    stamped.header.stamp = {static_cast<std::int32_t>(random_()),
                            static_cast<std::uint32_t>(random_())};
    stamped.header.frame_id = text().data();
    stamped.twist = twist();
    const char* const velocity = geometry_msgs_msg_dds__Twist__desc.m_typename;
    std_msgs_msg_dds__String_ string{text_.data()};
    switch (pick(impostor_ ? 7 : 5)) {
      case 0:  // another operator's velocity
        return one.send("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc, velocity, &stamped.twist);
      case 1:  // another type of it, wrong frame, stale stamp
        return one.send("rt/cmd_vel", geometry_msgs_msg_dds__TwistStamped__desc,
                        geometry_msgs_msg_dds__TwistStamped__desc.m_typename, &stamped);
      case 2:  // what follows is not what it is called
        return one.send("rt/cmd_vel", std_msgs_msg_dds__String__desc, velocity, &string);
      case 3:
        return one.send("sandrunner/mode_request", geometry_msgs_msg_dds__TwistStamped__desc,
                        sandrunner_ModeRequest_desc.m_typename, &stamped);
      case 4:
        return one.send("rt/sandrunner/request", geometry_msgs_msg_dds__Twist__desc,
                        std_msgs_msg_dds__String__desc.m_typename, &stamped.twist);
      case 5: {  // another robot
        sandrunner_ModeReply reply{};
        reply.accepted = pick(2) == 0;
        for (char* field : {reply.mode, reply.robot, reply.reason}) {
          text().copy(field, sizeof reply.mode - 1);
        }
        return one.send("sandrunner/mode_reply", sandrunner_ModeReply_desc,
                        sandrunner_ModeReply_desc.m_typename, &reply);
      }
      default: {  // its ticks
        std::vector<sandrunner_TickState> ticks(static_cast<std::size_t>(pick(41)));
        for (sandrunner_TickState& tick : ticks) {
          tick = {};
          tick.tick = random_();
          tick.faults = random_();
          tick.mode = static_cast<std::uint32_t>(random_());
          for (float& command : tick.command) command = static_cast<float>(value());
        }
        sandrunner_TickBatch batch{};
        batch.sequence_number = random_();
        batch.ticks._length = batch.ticks._maximum = static_cast<std::uint32_t>(ticks.size());
        batch.ticks._buffer = ticks.data();
        return one.send("sandrunner/ticks", sandrunner_TickBatch_desc,
                        sandrunner_TickBatch_desc.m_typename, &batch);
      }
    }
  }

  /// Packets to the robot's ports (RTPS 2.3, 8.3 and 9.6), more or less in form.
  void packet() {
    constexpr std::array<std::uint8_t, 14> kKinds = {1,  6,  7,  8,  9,    12,   13,
                                                     14, 15, 18, 19, 0x15, 0x16, 0x80};
    const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    for (int i = 0; i < 20; ++i) {
      std::vector<std::uint8_t> bytes = {'R', 'T', 'P', 'S', 2, 1, 1, 16};
      for (int k = 0; k < 12; ++k) bytes.push_back(byte());
      for (int parts = 1 + pick(4); parts > 0; --parts) {
        const int size = pick(10) == 0 ? pick(60000) : 4 * pick(30);
        const bool honest = pick(4) != 0;
        bytes.push_back(kKinds[static_cast<std::size_t>(pick(kKinds.size()))]);
        bytes.push_back(static_cast<std::uint8_t>(pick(3) == 0 ? byte() : 5));
        bytes.push_back(honest ? static_cast<std::uint8_t>(size) : byte());
        bytes.push_back(honest ? static_cast<std::uint8_t>(size >> 8) : byte());
        for (int k = 0; k < size; ++k) bytes.push_back(pick(3) == 0 ? byte() : 0);
      }
      if (bytes.size() > 65000) bytes.resize(65000);
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain_ + pick(14)));
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      sendto(udp, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
    close(udp);
  }

  int domain_;
  std::mt19937_64 random_;
  DdsParticipant participant_;
  dds_entity_t velocities_, requests_, texts_;
  std::vector<dds_entity_t> services_;
  std::string text_;
  bool impostor_;  ///< beside another robot, this one obeys nobody
};

int run(char** argv) {
  const double duration_s = std::atof(argv[3]);
  const Bounds bounds{std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6]),
                      std::atof(argv[7]), std::atof(argv[8])};
  Attacker attacker(std::atoi(argv[1]), static_cast<unsigned>(std::atoll(argv[2])));
  Stranger watcher(attacker.domain());
  const dds_entity_t reader = watcher.ticks();
  long seen = 0, modes = 0;
  const char* broken = nullptr;
  const auto look = [&] {
    take(reader, [&](const void* message, const dds_sample_info_t&) {
      const auto& batch = *static_cast<const sandrunner_TickBatch*>(message);
      for (std::uint32_t i = 0; i < batch.ticks._length && !broken; ++i) {
        const sandrunner_TickState& tick = batch.ticks._buffer[i];
        ++seen;
        modes |= 1L << (tick.mode & 31);
        if ((broken = bounds.broken(tick))) {
          std::fprintf(stderr, "dds_attacker: tick %llu in mode %u: %s out of bounds\n",
                       static_cast<unsigned long long>(tick.tick), tick.mode, broken);
        }
      }
    });
  };
  const auto found_by = Steady::now() + std::chrono::seconds(5);
  while (seen == 0 && Steady::now() < found_by) {
    look();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const auto end = Steady::now() + std::chrono::duration<double>(duration_s);
  while (seen > 0 && !broken && Steady::now() < end) {
    attacker.strike();
    look();
  }
  std::printf("ticks %ld modes %ld\n", seen, modes);
  return broken ? 3 : 0;
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  try {
    return argc == 9 ? sandrunner::run(argv) : 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "dds_attacker: %s\n", e.what());
    return 2;
  }
}
