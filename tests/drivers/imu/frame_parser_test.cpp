// SPDX-License-Identifier: BSD-3-Clause
// What holds for the parser of either protocol.
#include "drivers/imu/frame_parser.h"

#include <gtest/gtest.h>

#include <random>

#include "drivers/imu/imu_reading.h"
#include "tests/drivers/imu/found_frames.h"

namespace sandrunner {
namespace {

ImuReading numbered_reading(std::uint64_t number) {
  return {.device_ns = 100'000 * number,
          .acceleration_mps2 = Vector3{0.125, -0.25, 9.75},
          .angular_velocity_radps = Vector3{1.5, -2.5, 0.0625},
          .orientation_wxyz = std::array{0.5, -0.5, 0.5, 0.5}};
}

struct MipFrames : FoundFrames<mip::Parser> {
  using FoundFrames::FoundFrames;
  static constexpr std::uint8_t kLongest = 255;     // that one byte of length can claim
  static constexpr std::size_t kMostSwallowed = 4;  // frames of data, by a false one
  static ByteVector command() { return bytes_of(mip::ping()); }
  static ByteVector data(std::uint64_t number) {
    return bytes_of(mip::encode_sensor_data(to_mip(numbered_reading(number))));
  }
};

struct XsensFrames : FoundFrames<xsens::Parser> {
  using FoundFrames::FoundFrames;
  static constexpr std::uint8_t kLongest = 254;
  static constexpr std::size_t kMostSwallowed = 34;
  static ByteVector command() { return bytes_of(xsens::Message(xsens::kGoToMeasurement)); }
  static ByteVector data(std::uint64_t number) {
    return bytes_of(xsens::encode_sensor_data(to_xsens(numbered_reading(number))));
  }
};

/// What the parser should hand on of a frame of data: with either protocol its fourth byte is the
/// length of what follows.
ByteVector content_of(const ByteVector& frame) {
  return {frame.begin() + 4, frame.begin() + 4 + frame[3]};
}

template <typename Frames>
class FrameParserTest : public testing::Test {};
using Protocols = testing::Types<MipFrames, XsensFrames>;
TYPED_TEST_SUITE(FrameParserTest, Protocols);

TYPED_TEST(FrameParserTest, FrameSplitAnywhereIsFound) {
  const ByteVector frame = TypeParam::data(5);
  for (std::size_t cut = 0; cut <= frame.size(); ++cut) {
    TypeParam found;
    found.feed(Bytes(frame).first(cut));
    found.feed(Bytes(frame).subspan(cut));
    ASSERT_EQ(found.datas, (std::vector<ByteVector>{content_of(frame)})) << cut;
  }
  EXPECT_EQ(TypeParam(frame, 1).datas.size(), 1U);
}

TYPED_TEST(FrameParserTest, RepliesAndDataInOneReadAreAllFound) {
  const ByteVector data = TypeParam::data(1), reply = TypeParam::command();
  const TypeParam found(data + reply + data);
  EXPECT_EQ(found.kinds, (ByteVector{data[2], reply[2], data[2]}));
  EXPECT_EQ(found.parser.skipped_bytes(), 0U);
}

TYPED_TEST(FrameParserTest, GarbageBetweenFramesIsCounted) {
  const ByteVector frame = TypeParam::command();
  const ByteVector garbage{0x00, frame[0], frame[0], 0x36, frame[1]};
  for (const std::size_t chunk : {1, 2, 3, 100}) {
    const TypeParam found(garbage + frame + garbage + frame, chunk);
    EXPECT_EQ(found.datas.size(), 2U);
    EXPECT_EQ(found.parser.skipped_bytes(), 10U);
    EXPECT_EQ(found.parser.bad_checksums(), 0U);
  }
}

TYPED_TEST(FrameParserTest, EveryBrokenByteCostsOnlyItsOwnFrame) {
  const ByteVector frame = TypeParam::data(5);
  const ByteVector rest = frame + frame + frame + frame + frame;  // for which a false length waits
  for (std::size_t at = 0; at < frame.size(); ++at) {
    ByteVector broken = frame;
    broken[at] ^= 0x55;
    const TypeParam found(frame + broken + rest);
    EXPECT_EQ(found.datas.size(), 6U) << at;
    EXPECT_EQ(found.parser.skipped_bytes(), frame.size()) << at;
    EXPECT_EQ(found.parser.bad_checksums(), at < 2 ? 0U : 1U) << at;
  }
}

TYPED_TEST(FrameParserTest, FramesInsideAFalseOneAreFound) {
  ByteVector stream = TypeParam::data(0);
  stream.resize(3);
  stream.push_back(TypeParam::kLongest);  // swallows four of them
  std::vector<ByteVector> sent;
  for (std::uint64_t i = 0; i < 5; ++i) {
    stream = stream + TypeParam::data(i);
    sent.push_back(content_of(TypeParam::data(i)));
  }
  const TypeParam found(stream);
  EXPECT_EQ(found.datas, sent);
  EXPECT_EQ(found.parser.skipped_bytes(), 4U);
}

TYPED_TEST(FrameParserTest, FrameHasTheTimeOfItsFirstByte) {
  const ByteVector frame = TypeParam::command(), stream = ByteVector{1, 2, 3} + frame + frame;
  for (std::size_t cut = 1; cut < stream.size(); ++cut) {
    TypeParam found;
    found.feed(Bytes(stream).first(cut), 10);
    found.feed(Bytes(stream).subspan(cut), 20);
    const std::int64_t first_ns = cut > 3 ? 10 : 20, second_ns = cut > 3 + frame.size() ? 10 : 20;
    EXPECT_EQ(found.times_ns, (std::vector{first_ns, second_ns})) << cut;
  }
}

TYPED_TEST(FrameParserTest, RandomBytesLoseNothingThatFollows) {
  std::mt19937 random(3);
  const ByteVector frame = TypeParam::data(9);
  ByteVector tail;
  for (int i = 0; i < 50; ++i) tail = tail + frame;
  for (int round = 0; round < 200; ++round) {
    ByteVector noise(random() % 600);
    for (auto& byte : noise) {
      const unsigned kind = random() % 4;
      byte = kind < 2 ? frame[kind] : static_cast<std::uint8_t>(random());
    }
    const TypeParam found(noise + tail, 1 + random() % 70);
    EXPECT_GE(found.datas.size(), 50U - TypeParam::kMostSwallowed);
    for (const ByteVector& data : found.datas) {
      // Xsens' checksum of one byte fits noise now and then.
      const bool is_noise = std::is_same_v<TypeParam, XsensFrames> && data.size() != frame[3];
      EXPECT_TRUE(is_noise || data == content_of(frame));
    }
  }
}

}  // namespace
}  // namespace sandrunner
