// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu.h"

#include <random>

#include "tests/drivers/imu/imu_fixture.h"
#include "tests/policy/allocation_counter.h"

namespace sandrunner {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using State = Imu::State;

/// What holds with either protocol.
class EveryImuTest : public ImuTest, public testing::WithParamInterface<ImuProtocol> {
 protected:
  EveryImuTest() : ImuTest(GetParam()) {}
};
INSTANTIATE_TEST_SUITE_P(Protocols, EveryImuTest,
                         testing::Values(ImuProtocol::kMip, ImuProtocol::kXsens),
                         [](const auto& test) {
                           return test.param == ImuProtocol::kMip ? "Mip" : "Xsens";
                         });

TEST_P(EveryImuTest, IsSetUpAndStreams) {
  const auto imu = set_up(config());
  EXPECT_TRUE(streaming());
  stream(*imu, 10);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
  const ImuSample& sample = imu->sample();
  EXPECT_EQ(sample.orientation_wxyz, (std::array<double, 4>{1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(sample.angular_velocity_radps, (Vector3{0.0, 0.5, 0.0}));
  EXPECT_NEAR(sample.linear_acceleration_mps2[2], 9.80665, 1e-6);
  EXPECT_EQ(imu->counters().bad_checksums, 0U);
  EXPECT_EQ(imu->counters().wrong_length, 0U);
}

TEST_P(EveryImuTest, DeviceThatDoesNotAnswerIsRefused) {
  mute_ = true;
  const std::string last_baud = is_mip() ? "3000000" : "2000000";
  const std::string sensor = is_mip() ? "a MicroStrain" : "an Xsens";
  EXPECT_EQ(refusal(config()), "IMU " + link_ + ": no answer at 115200, 230400, 460800, 921600, " +
                                   last_baud + " baud, 0 bytes heard; is it " + sensor +
                                   " sensor, powered, RX to TX?");
}

TEST_P(EveryImuTest, CommandThatGoesUnansweredIsRepeated) {
  forgotten_ = is_mip() ? mip::k3dmCommands : xsens::kOutputs;
  const auto imu = set_up(config());
  EXPECT_EQ(forgotten_, 0);
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
}

TEST_P(EveryImuTest, SamplesHaveTheTimeOfTheirOrigin) {
  const auto imu = set_up(config());
  stream(*imu, 5);
  // Read 3 ms late: the sample is as old as that.
  const std::int64_t taken_ns = imu->sample_time_ns() + 2 * kMs;
  now_ns_ += 5 * kMs;
  send(*imu, reading());
  EXPECT_NEAR(static_cast<double>(imu->sample_time_ns() - taken_ns), 0.0, 0.01 * kMs);
}

TEST_P(EveryImuTest, PacketInPiecesIsTakenWhenItIsComplete) {
  const auto imu = set_up(config());
  const ByteVector packet = bytes_of(reading());
  const std::uint64_t samples = imu->counters().samples;
  send(*imu, Bytes(packet).first(20));
  send(*imu, Bytes(packet).subspan(20, packet.size() - 21));
  EXPECT_EQ(imu->counters().samples, samples);
  send(*imu, Bytes(packet).last(1));
  EXPECT_EQ(imu->counters().samples, samples + 1);
}

TEST_P(EveryImuTest, ReplyBetweenDataIsNoTrouble) {
  const auto imu = set_up(config());
  const std::uint64_t others = imu->counters().other_packets;
  stream(*imu, 1);
  send(*imu, is_mip() ? copy(mip::acknowledge(mip::kBaseCommands, mip::kPing, 0).bytes())
                      : copy(xsens::Message(xsens::kGoToConfig + 1).bytes()));
  stream(*imu, 1);
  EXPECT_EQ(imu->counters().other_packets, others + 1);
  EXPECT_EQ(imu->counters().skipped_bytes, 0U);
}

TEST_P(EveryImuTest, SilenceIsTold) {
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

TEST_P(EveryImuTest, RepeatedPacketIsNoSample) {
  const auto imu = set_up(config());
  stream(*imu, 5);
  ImuReading stuck = reading();
  send(*imu, stuck);
  const std::uint64_t samples = imu->counters().samples, repeated = imu->counters().repeated;
  stuck.angular_velocity_radps = Vector3{0.9, 0.9, 0.9};  // whatever it says: its clock stands
  for (int i = 0; i < 10; ++i) {
    now_ns_ += 2 * kMs;
    send(*imu, stuck);
  }
  EXPECT_EQ(imu->counters().samples, samples);
  EXPECT_EQ(imu->counters().repeated, repeated + 10);
  EXPECT_EQ(imu->sample().angular_velocity_radps[1], 0.5);
  EXPECT_EQ(imu->state(now_ns_), State::kRepeating);
}

TEST_P(EveryImuTest, GarbageIsToldAndWhatFollowsItIsRead) {
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

TEST_P(EveryImuTest, BrokenChecksumCostsOneSample) {
  const auto imu = set_up(config());
  ByteVector broken = bytes_of(reading());
  broken[20] ^= 1;
  const std::uint64_t samples = imu->counters().samples;
  send(*imu, broken);
  stream(*imu, 2);
  EXPECT_EQ(imu->counters().samples, samples + 2);
  EXPECT_EQ(imu->counters().bad_checksums, 1U);
  EXPECT_EQ(imu->counters().skipped_bytes, broken.size());
}

TEST_P(EveryImuTest, FieldOfWrongLengthMakesNoSample) {
  const auto imu = set_up(config());
  ImuReading data = reading();
  data.angular_velocity_radps.reset();
  ByteVector sent;
  if (is_mip()) {
    mip::Packet packet = mip::encode_sensor_data(to_mip(data));
    packet.add(mip::kGyro, ByteVector(8));
    sent = copy(packet.bytes());
  } else {
    ByteVector fields = copy(xsens::encode_sensor_data(to_xsens(data)).data());
    fields.insert(fields.end(), {0x80, 0x20, 4, 0, 0, 0, 0});
    sent = copy(xsens::Message(xsens::kSensorData, fields).bytes());
  }
  const std::uint64_t samples = imu->counters().samples;
  send(*imu, sent);
  EXPECT_EQ(imu->counters().samples, samples);
  EXPECT_EQ(imu->counters().wrong_length, 1U);
  EXPECT_EQ(imu->counters().incomplete, 1U);
}

TEST_P(EveryImuTest, QuaternionsAtAHalfOfTheRateSuffice) {
  ImuConfig half = config();
  half.rate_hz = is_mip() ? 1000 : 400;
  half.quaternion_rate_hz = half.rate_hz / 2;
  const auto imu = set_up(half);
  const std::uint64_t samples = imu->counters().samples;
  for (int i = 0; i < 20; ++i) {
    now_ns_ += 2 * kMs;
    ImuReading data = reading();
    if (i % 2 == 1) data.orientation_wxyz.reset();
    send(*imu, data);
  }
  EXPECT_EQ(imu->counters().samples, samples + 20);
}

TEST_P(EveryImuTest, StreamWithoutQuaternionsIsNoStreamOfSamples) {
  const auto imu = set_up(config());
  for (int i = 0; i < 20; ++i) {
    now_ns_ += 2 * kMs;
    ImuReading data = reading();
    data.orientation_wxyz.reset();
    send(*imu, data);
  }
  EXPECT_GT(imu->counters().incomplete, 10U);
  EXPECT_EQ(imu->state(now_ns_), State::kGarbage);
}

TEST_P(EveryImuTest, DeviceThatStartsAnewIsFollowed) {
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

TEST_P(EveryImuTest, UnpluggedLineIsToldAndANewReaderReadsTheNextOne) {
  auto imu = set_up(config());
  stream(*imu, 3);
  pty_->unplug();
  poll_until(*imu, [&] { return imu->state(now_ns_) == State::kGone; });
  EXPECT_FALSE(imu->poll(now_ns_));
  const ImuConfig again = config();
  imu.reset();
  plug_in();
  device_ = new_device();
  device_ns_ = 0;
  imu = set_up(again);
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), State::kStreaming);
}

TEST_P(EveryImuTest, PollAllocatesNothing) {
  const auto imu = set_up(config());
  pty_->write(bytes_of(reading()));
  const std::uint64_t samples = imu->counters().samples;
  const std::size_t before = number_of_allocations();
  poll_until(*imu, [&] { return imu->counters().samples > samples; });
  EXPECT_EQ(number_of_allocations(), before);
}

TEST_P(EveryImuTest, LineThatIsInUseIsRefused) {
  const auto imu = set_up(config());
  EXPECT_THAT(refusal(config()), AllOf(HasSubstr(link_), HasSubstr("in use")));
}

}  // namespace
}  // namespace sandrunner
