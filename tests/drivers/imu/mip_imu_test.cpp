// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/mip_imu.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <random>
#include <thread>

#include "drivers/imu/mip_device.h"
#include "rt/base/errors.h"
#include "tests/drivers/imu/pty.h"
#include "tests/policy/allocation_counter.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using State = MipImu::State;

constexpr std::int64_t kMs = 1'000'000;

std::int64_t real_now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// An IMU on the far end of a serial line. While the driver sets it up a thread speaks for it; then
/// the test does, in the time that it makes up.
class ImuTest : public testing::Test {
 protected:
  /// What the reader is told to do, by the name under which the line is found.
  MipImuConfig config() const {
    MipImuConfig config;
    config.device = link_;
    return config;
  }

  void plug_in() {
    pty_ = std::make_unique<Pty>();
    std::filesystem::remove(link_);
    std::filesystem::create_symlink(pty_->path(), link_);
  }

  /// The reader, set up; all that the device has sent meanwhile is read.
  std::unique_ptr<MipImu> set_up(const MipImuConfig& config) {
    std::unique_ptr<MipImu> imu;
    {
      const std::jthread server([this](const std::stop_token& stop) { serve(stop); });
      imu = std::make_unique<MipImu>(config);
    }
    now_ns_ = real_now_ns();
    mip::SensorData marker = sample();
    marker.gyro_radps = {7.0F, 0.0F, 0.0F};
    pty_->write(encode_sensor_data(marker).bytes());
    poll_until(*imu, [&] { return imu->sample().angular_velocity_radps[0] == 7.0; });
    return imu;
  }
  std::string refusal(const MipImuConfig& config) {
    const std::jthread server([this](const std::stop_token& stop) { serve(stop); });
    try {
      const MipImu imu(config);
      return "set up";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  /// The next sample: at rest, level, a period later on the device's clock.
  mip::SensorData sample(std::uint64_t period_ns = 2 * kMs) {
    device_ns_ += period_ns;
    mip::SensorData data;
    data.accel_g = {0.0F, 0.0F, -1.0F};
    data.gyro_radps = {0.0F, 0.5F, 0.0F};
    data.quaternion_wxyz = {1.0F, 0.0F, 0.0F, 0.0F};
    data.reference_time_ns = device_ns_;
    return data;
  }

  /// Sends, and polls until all of it has arrived.
  void send(MipImu& imu, mip::Bytes bytes) {
    const std::uint64_t wanted = imu.counters().bytes + bytes.size();
    pty_->write(bytes);
    poll_until(imu, [&] { return imu.counters().bytes >= wanted; });
  }
  void send(MipImu& imu, const mip::SensorData& data) {
    send(imu, mip::encode_sensor_data(data).bytes());
  }
  template <typename Holds>
  void poll_until(MipImu& imu, Holds holds) {
    const std::int64_t deadline_ns = real_now_ns() + 5000 * kMs;
    while (!holds()) {
      ASSERT_LT(real_now_ns(), deadline_ns) << "did not arrive";
      imu.poll(now_ns_);
      sched_yield();
    }
  }
  /// Some good samples, 2 ms apart.
  void stream(MipImu& imu, int count) {
    for (int i = 0; i < count; ++i) {
      now_ns_ += 2 * kMs;
      send(imu, sample());
    }
  }

  TemporaryFolder folder_;
  std::string link_ = folder_.path("imu");
  std::unique_ptr<Pty> pty_;
  mip::Device device_{1000, 921600};
  bool mute_ = false;
  std::atomic<std::uint8_t> forgotten_set_{0};  ///< commands of this set are not answered once
  std::uint64_t device_ns_ = 1'000'000'000;
  std::int64_t now_ns_ = 0;

 private:
  void SetUp() override { plug_in(); }

  void serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::vector<std::uint8_t> bytes = pty_->read(2);
      if (mute_) continue;
      if (pty_->baud() != device_.baud()) {
        // At another speed the two hear nothing but garbage of each other.
        for (auto& byte : bytes) byte = static_cast<std::uint8_t>(byte * 37 + 11);
      } else if (bytes.size() > 2 && bytes[2] == forgotten_set_) {
        forgotten_set_ = 0;
        continue;
      }
      std::vector<std::uint8_t> answer = device_.receive(bytes);
      if (device_.streaming()) {
        for (int tick = 0; tick < 2; ++tick) {  // of its base rate of 1 kHz
          if (const auto packet = device_.tick(sample(kMs))) {
            answer.insert(answer.end(), packet->bytes().begin(), packet->bytes().end());
          }
        }
      }
      pty_->write(answer);
    }
  }
};

TEST_F(ImuTest, IsFoundToldItsSpeedAndStreams) {
  device_ = mip::Device(1000, 115200);
  const auto imu = set_up(config());
  EXPECT_EQ(device_.baud(), 921600U);
  EXPECT_EQ(pty_->baud(), 921600U);
  EXPECT_TRUE(device_.streaming());
  stream(*imu, 10);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
  const ImuSample& sample = imu->sample();
  EXPECT_EQ(sample.orientation_wxyz, (std::array<double, 4>{1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(sample.angular_velocity_radps, (Vector3{0.0, -0.5, 0.0}));
  EXPECT_NEAR(sample.linear_acceleration_mps2[2], 9.80665, 1e-12);
  EXPECT_EQ(imu->counters().bad_checksums, 0U);
  EXPECT_EQ(imu->counters().wrong_length, 0U);
}

TEST_F(ImuTest, DeviceThatAlreadyStreamsIsSetUpToo) {
  const std::array<mip::DecimatedField, 2> fields{{{mip::kAccel, 1}, {mip::kGyro, 1}}};
  device_.receive(mip::message_format(mip::kSensorData, fields).bytes());
  device_.receive(mip::stream_control(mip::kSensorData, true).bytes());
  ASSERT_TRUE(device_.streaming());
  const auto imu = set_up(config());
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
}

TEST_F(ImuTest, CommandThatGoesUnansweredIsRepeated) {
  forgotten_set_ = mip::k3dmCommands;
  const auto imu = set_up(config());
  EXPECT_EQ(forgotten_set_, 0);
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
}

TEST_F(ImuTest, SamplesHaveTheTimeOfTheirOrigin) {
  const auto imu = set_up(config());
  stream(*imu, 5);
  // Read 3 ms late: the sample is as old as that.
  const std::int64_t taken_ns = imu->sample_time_ns() + 2 * kMs;
  now_ns_ += 5 * kMs;
  send(*imu, sample());
  EXPECT_NEAR(static_cast<double>(imu->sample_time_ns() - taken_ns), 0.0, 0.01 * kMs);
}

TEST_F(ImuTest, PacketInPiecesIsTakenWhenItIsComplete) {
  const auto imu = set_up(config());
  const mip::SensorData data = sample();
  const mip::Packet packet = mip::encode_sensor_data(data);
  const std::uint64_t samples = imu->counters().samples;
  send(*imu, packet.bytes().first(20));
  send(*imu, packet.bytes().subspan(20, 41));
  EXPECT_EQ(imu->counters().samples, samples);
  send(*imu, packet.bytes().last(1));
  EXPECT_EQ(imu->counters().samples, samples + 1);
}

TEST_F(ImuTest, ReplyBetweenDataIsNoTrouble) {
  const auto imu = set_up(config());
  const std::uint64_t others = imu->counters().other_packets;
  stream(*imu, 1);
  send(*imu, mip::acknowledge(mip::kBaseCommands, mip::kPing, 0).bytes());
  stream(*imu, 1);
  EXPECT_EQ(imu->counters().other_packets, others + 1);
  EXPECT_EQ(imu->counters().skipped_bytes, 0U);
}

TEST_F(ImuTest, SilenceIsTold) {
  const auto imu = set_up(config());
  stream(*imu, 5);
  now_ns_ += imu->limit_ns();
  EXPECT_FALSE(imu->poll(now_ns_));
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
  EXPECT_EQ(imu->state(now_ns_ + 1), State::kSilent);
  now_ns_ += 10'000 * kMs;
  stream(*imu, 1);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
}

TEST_F(ImuTest, RepeatedPacketIsNoSample) {
  const auto imu = set_up(config());
  stream(*imu, 5);
  mip::SensorData stuck = sample();
  send(*imu, stuck);
  const std::uint64_t samples = imu->counters().samples, repeated = imu->counters().repeated;
  stuck.gyro_radps = {0.9F, 0.9F, 0.9F};  // whatever it says: its clock stands
  for (int i = 0; i < 10; ++i) {
    now_ns_ += 2 * kMs;
    send(*imu, stuck);
  }
  EXPECT_EQ(imu->counters().samples, samples);
  EXPECT_EQ(imu->counters().repeated, repeated + 10);
  EXPECT_EQ(imu->sample().angular_velocity_radps[1], -0.5);
  EXPECT_EQ(imu->state(now_ns_), State::kRepeating);
}

TEST_F(ImuTest, GarbageIsToldAndWhatFollowsItIsRead) {
  const auto imu = set_up(config());
  stream(*imu, 5);
  std::mt19937 random(1);
  for (int i = 0; i < 10; ++i) {
    now_ns_ += 2 * kMs;
    std::array<std::uint8_t, 62> noise;
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
    send(*imu, noise);
  }
  EXPECT_EQ(imu->state(now_ns_), State::kGarbage);
  EXPECT_GE(imu->counters().skipped_bytes + 261, 620U);
  stream(*imu, 6);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
}

TEST_F(ImuTest, BrokenChecksumCostsOneSample) {
  const auto imu = set_up(config());
  mip::SensorData data = sample();
  const mip::Packet packet = mip::encode_sensor_data(data);
  std::vector<std::uint8_t> broken(packet.bytes().begin(), packet.bytes().end());
  broken[20] ^= 1;
  const std::uint64_t samples = imu->counters().samples;
  send(*imu, broken);
  stream(*imu, 2);
  EXPECT_EQ(imu->counters().samples, samples + 2);
  EXPECT_EQ(imu->counters().bad_checksums, 1U);
  EXPECT_EQ(imu->counters().skipped_bytes, broken.size());
}

TEST_F(ImuTest, FieldOfWrongLengthMakesNoSample) {
  const auto imu = set_up(config());
  mip::SensorData data = sample();
  data.gyro_radps.reset();
  mip::Packet packet = mip::encode_sensor_data(data);
  packet.add(mip::kGyro, std::vector<std::uint8_t>(8));
  const std::uint64_t samples = imu->counters().samples;
  send(*imu, packet.bytes());
  EXPECT_EQ(imu->counters().samples, samples);
  EXPECT_EQ(imu->counters().wrong_length, 1U);
  EXPECT_EQ(imu->counters().wrong_length_field, mip::kGyro);
  EXPECT_EQ(imu->counters().incomplete, 1U);
}

TEST_F(ImuTest, QuaternionsAtAHalfOfTheRateSuffice) {
  MipImuConfig half = config();
  half.rate_hz = 1000;
  half.quaternion_rate_hz = 500;
  const auto imu = set_up(half);
  const std::uint64_t samples = imu->counters().samples;
  for (int i = 0; i < 20; ++i) {
    now_ns_ += 2 * kMs;
    mip::SensorData data = sample();
    if (i % 2 == 1) data.quaternion_wxyz.reset();
    send(*imu, data);
  }
  EXPECT_EQ(imu->counters().samples, samples + 20);
}

TEST_F(ImuTest, StreamWithoutQuaternionsIsNoStreamOfSamples) {
  const auto imu = set_up(config());
  for (int i = 0; i < 20; ++i) {
    now_ns_ += 2 * kMs;
    mip::SensorData data = sample();
    data.quaternion_wxyz.reset();
    send(*imu, data);
  }
  EXPECT_GT(imu->counters().incomplete, 10U);
  EXPECT_EQ(imu->state(now_ns_), State::kGarbage);
}

TEST_F(ImuTest, DeviceThatStartsAnewIsFollowed) {
  const auto imu = set_up(config());
  stream(*imu, 10);
  device_ns_ = 0;
  const std::uint64_t samples = imu->counters().samples;
  stream(*imu, 10);
  EXPECT_EQ(imu->counters().samples, samples + 9);
  EXPECT_EQ(imu->counters().clock_restarts, 1U);
  EXPECT_LE(imu->sample_time_ns(), now_ns_);
  EXPECT_GT(imu->sample_time_ns(), now_ns_ - kMs);
}

TEST_F(ImuTest, UnpluggedLineIsToldAndANewReaderReadsTheNextOne) {
  auto imu = set_up(config());
  stream(*imu, 3);
  pty_->unplug();
  poll_until(*imu, [&] { return imu->state(now_ns_) == State::kGone; });
  EXPECT_FALSE(imu->poll(now_ns_));
  const MipImuConfig again = config();
  imu.reset();
  plug_in();
  device_ = mip::Device(1000, 921600);
  device_ns_ = 0;
  imu = set_up(again);
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
}

TEST_F(ImuTest, PollAllocatesNothing) {
  const auto imu = set_up(config());
  const mip::Packet packet = mip::encode_sensor_data(sample());
  pty_->write(packet.bytes());
  const std::uint64_t samples = imu->counters().samples;
  const std::size_t before = number_of_allocations();
  poll_until(*imu, [&] { return imu->counters().samples > samples; });
  EXPECT_EQ(number_of_allocations(), before);
}

TEST_F(ImuTest, DeviceThatDoesNotAnswerIsRefused) {
  mute_ = true;
  EXPECT_EQ(refusal(config()),
            "IMU " + link_ +
                ": no answer at 115200, 230400, 460800, 921600, 3000000 baud, 0 bytes heard; is it "
                "a MicroStrain sensor, powered, RX to TX?");
}

TEST_F(ImuTest, RateThatTheBaseRateIsNoMultipleOfIsRefused) {
  MipImuConfig odd = config();
  odd.rate_hz = odd.quaternion_rate_hz = 300;
  EXPECT_EQ(refusal(odd), "IMU " + link_ +
                              ": a rate of 300 Hz is not the device's base rate of 1000 Hz over a "
                              "whole number");
  EXPECT_FALSE(device_.streaming());
}

TEST_F(ImuTest, DeviceWithoutABaseRateIsRefused) {
  device_ = mip::Device(0, 921600);
  EXPECT_THAT(refusal(config()), HasSubstr("has no fixed base rate"));
}

TEST_F(ImuTest, LineThatIsInUseIsRefused) {
  const auto imu = set_up(config());
  EXPECT_THAT(refusal(config()), AllOf(HasSubstr(link_), HasSubstr("in use")));
}

TEST(MipImuCheckTest, LoadsAreThoseOfTheBytes) {
  EXPECT_NEAR(mip_line_load(500, 500, 921600), 0.336, 0.001);
  EXPECT_NEAR(mip_line_load(1000, 1000, 921600), 0.673, 0.001);
  EXPECT_NEAR(mip_line_load(1000, 500, 921600), 0.575, 0.001);
  EXPECT_NEAR(mip_line_load(500, 500, 115200), 2.691, 0.001);
}

TEST(MipImuCheckTest, StreamThatDoesNotFitIsRefusedBeforeTheLineIsOpened) {
  const auto refusal = [](unsigned baud, int rate_hz, int quaternion_rate_hz) -> std::string {
    try {
      const MipImu imu({"/nowhere", baud, rate_hz, quaternion_rate_hz, {}});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(115200, 1000, 1000),
            "IMU /nowhere: samples at 1000 Hz with quaternions at 1000 Hz need 620000 bit/s, 538 % "
            "of 115200 baud, and at most 80 % may be used: 921600 baud is enough, or at most 148 "
            "Hz of both");
  EXPECT_THAT(refusal(115200, 500, 500), HasSubstr("460800 baud is enough"));
  EXPECT_EQ(refusal(57600, 100, 100),
            "IMU /nowhere: 57600 baud is none of 115200, 230400, 460800, 921600, 3000000");
  EXPECT_EQ(refusal(921600, 500, 300),
            "IMU /nowhere: a quaternion rate of 300 Hz is not the rate of 500 Hz over a whole "
            "number");
  EXPECT_EQ(refusal(921600, 0, 0), "IMU /nowhere: a rate of 0 Hz is not within 1 to 1000 Hz");
  EXPECT_THAT(refusal(115200, 100, 100), HasSubstr("/nowhere: does not exist"));
}

}  // namespace
}  // namespace sandrunner
