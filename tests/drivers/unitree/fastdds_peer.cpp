// SPDX-License-Identifier: BSD-3-Clause
// A robot's end of Unitree's DDS topics on eProsima's Fast DDS, which shares no code with the
// driver: types by fastddsgen, CRCs from a layout of its own.
//   unitree_fastdds_peer DOMAIN
// Publishes states at 500 Hz, reads commands and answers motion_switcher until SIGTERM; then prints
// what it received.
#include <sched.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/fastdds_loopback.h"
#ifdef SANDRUNNER_FASTDDS_3
#include "unitree_apiPubSubTypes.hpp"
#include "unitree_goPubSubTypes.hpp"
#else
#include "unitree_apiPubSubTypes.h"
#include "unitree_goPubSubTypes.h"
#endif

namespace {

namespace dds = eprosima::fastdds::dds;
using unitree_api::msg::dds_::Request_;
using unitree_api::msg::dds_::Response_;
using unitree_go::msg::dds_::LowCmd_;
using unitree_go::msg::dds_::LowState_;

volatile std::sig_atomic_t ended = 0;

/// A struct as a C compiler lays it out, padding zero.
class Image {
 public:
  template <typename T>
  void add(T value) {
    align(sizeof value);
    bytes_.resize(bytes_.size() + sizeof value);
    std::memcpy(bytes_.data() + bytes_.size() - sizeof value, &value, sizeof value);
  }
  template <typename T, std::size_t kSize>
  void add(const std::array<T, kSize>& values) {
    for (const T value : values) add(value);
  }
  void align(std::size_t to) { bytes_.resize((bytes_.size() + to - 1) / to * to); }
  std::uint32_t crc() const {
    std::uint32_t crc = 0xFFFFFFFF;
    for (std::size_t i = 0; i < bytes_.size(); ++i) {
      crc ^= static_cast<std::uint32_t>(bytes_[i ^ 3]) << 24;
      for (int bit = 0; bit < 8; ++bit) crc = crc << 1 ^ ((crc >> 31) != 0 ? 0x04C11DB7u : 0u);
    }
    return crc;
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// The fields that both messages begin with.
template <typename Message>
void add_beginning(const Message& m, Image& image) {
  image.add(m.head());
  image.add(m.level_flag());
  image.add(m.frame_reserve());
  image.add(m.sn());
  image.add(m.version());
  image.add(m.bandwidth());
  image.align(4);
}

std::uint32_t crc_of(const LowCmd_& c) {
  Image image;
  add_beginning(c, image);
  for (const auto& motor : c.motor_cmd()) {
    image.add(motor.mode());
    for (const float value : {motor.q(), motor.dq(), motor.tau(), motor.kp(), motor.kd()}) {
      image.add(value);
    }
    image.add(motor.reserve());
  }
  image.add(c.bms_cmd().off());
  image.add(c.bms_cmd().reserve());
  image.add(c.wireless_remote());
  image.add(c.led());
  image.add(c.fan());
  image.add(c.gpio());
  image.add(c.reserve());
  return image.crc();
}

std::uint32_t crc_of(const LowState_& s) {
  Image image;
  add_beginning(s, image);
  const auto& imu = s.imu_state();
  image.add(imu.quaternion());
  image.add(imu.gyroscope());
  image.add(imu.accelerometer());
  image.add(imu.rpy());
  image.add(imu.temperature());
  image.align(4);
  for (const auto& m : s.motor_state()) {
    image.add(m.mode());
    for (const float value :
         {m.q(), m.dq(), m.ddq(), m.tau_est(), m.q_raw(), m.dq_raw(), m.ddq_raw()}) {
      image.add(value);
    }
    image.add(m.temperature());
    image.add(m.lost());
    image.add(m.reserve());
  }
  const auto& bms = s.bms_state();
  for (const auto value : {bms.version_high(), bms.version_low(), bms.status(), bms.soc()}) {
    image.add(value);
  }
  image.add(bms.current());
  image.add(bms.cycle());
  image.add(bms.bq_ntc());
  image.add(bms.mcu_ntc());
  image.add(bms.cell_vol());
  image.add(s.foot_force());
  image.add(s.foot_force_est());
  image.add(s.tick());
  image.add(s.wireless_remote());
  image.add(s.bit_flag());
  image.add(s.adc_reel());
  image.add(s.temperature_ntc1());
  image.add(s.temperature_ntc2());
  image.add(s.power_v());
  image.add(s.power_a());
  image.add(s.fan_frequency());
  image.add(s.reserve());
  return image.crc();
}

/// Lies, and is healthy; each motor slot has a position of its own.
LowState_ state_at(std::uint32_t tick_ms) {
  LowState_ state;
  state.head() = {0xFE, 0xEF};
  state.level_flag(0xFF);
  state.imu_state().quaternion() = {1.0F, 0.0F, 0.0F, 0.0F};
  state.imu_state().accelerometer() = {0.0F, 0.0F, 9.81F};
  for (std::size_t i = 0; i < state.motor_state().size(); ++i) {
    state.motor_state()[i].q(0.015625F * static_cast<float>(i));
    state.motor_state()[i].temperature(35);
  }
  state.bms_state().soc(80);
  state.foot_force() = {1, -2, 3, -4};
  state.tick(tick_ms);
  state.wireless_remote()[6] = 1;  // a stick that is not quite in its middle
  state.power_v(29.0F);
  state.crc(crc_of(state));
  return state;
}

template <typename PubSubType>
dds::Topic* make_topic(dds::DomainParticipant* participant, const char* topic) {
  const dds::TypeSupport support(new PubSubType());
  support.register_type(participant);
  return participant->create_topic(topic, support.get_type_name(), dds::TOPIC_QOS_DEFAULT);
}

template <typename Message, typename Use>
void take(dds::DataReader* reader, const Use& use) {
  dds::SampleInfo info;
  Message message;
  while (reader->take_next_sample(&message, &info) == sandrunner::kReturnedOk) {
    if (info.valid_data) use(message);
  }
}

void play(int domain) {
  dds::DomainParticipant* participant =
      dds::DomainParticipantFactory::get_instance()->create_participant(
          static_cast<dds::DomainId_t>(domain), sandrunner::fastdds_loopback_qos());
  dds::Subscriber* subscriber = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  dds::Publisher* publisher = participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  dds::DataWriter* states = publisher->create_datawriter(
      make_topic<unitree_go::msg::dds_::LowState_PubSubType>(participant, "rt/lowstate"),
      dds::DATAWRITER_QOS_DEFAULT);
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  qos.history().depth = 32;
  dds::DataReader* commands = subscriber->create_datareader(
      make_topic<unitree_go::msg::dds_::LowCmd_PubSubType>(participant, "rt/lowcmd"), qos);
  dds::DataReader* requests =
      subscriber->create_datareader(make_topic<unitree_api::msg::dds_::Request_PubSubType>(
                                        participant, "rt/api/motion_switcher/request"),
                                    qos);
  dds::DataWriter* responses =
      publisher->create_datawriter(make_topic<unitree_api::msg::dds_::Response_PubSubType>(
                                       participant, "rt/api/motion_switcher/response"),
                                   dds::DATAWRITER_QOS_DEFAULT);

  int right = 0, wrong = 0, releases = 0;
  LowCmd_ last;  // that asked for torque
  std::string mode = "ai";
  const auto start = std::chrono::steady_clock::now();
  for (std::uint32_t cycle = 0; ended == 0; ++cycle) {
    std::this_thread::sleep_until(start + cycle * std::chrono::milliseconds(2));
    LowState_ state = state_at(10'000 + 2 * cycle);
    states->write(&state);
    take<LowCmd_>(commands, [&](const LowCmd_& command) {
      ++(command.crc() == crc_of(command) ? right : wrong);
      if (command.motor_cmd()[0].kp() > 0.0F) last = command;
    });
    take<Request_>(requests, [&](const Request_& request) {
      Response_ response;
      response.header().identity(request.header().identity());
      if (request.header().identity().api_id() == 1003) {
        ++releases;
        mode.clear();
      } else {
        response.data(R"({"form":"0","name":")" + mode + "\"}");
      }
      responses->write(&response);
    });
  }
  const auto& motor = last.motor_cmd()[5];
  std::printf("right %d wrong %d releases %d\nhead %02X%02X mode %d q %.4f kp %.2f kd %.2f\n",
              right, wrong, releases, last.head()[0], last.head()[1], motor.mode(), motor.q(),
              motor.kp(), motor.kd());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::signal(SIGTERM, [](int) { ended = 1; });
  const sched_param priority{.sched_priority = 60};
  sched_setscheduler(0, SCHED_FIFO, &priority);  // if it may: on a busy computer it matters
  play(std::atoi(argv[1]));
  std::fflush(stdout);
  std::_Exit(0);  // without telling its peers
}
