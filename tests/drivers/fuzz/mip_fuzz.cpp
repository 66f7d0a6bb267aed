// SPDX-License-Identifier: BSD-3-Clause
// Any bytes on the IMU's serial line: the parser, the decoder, what the reader makes of the data,
// and the emulated device.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/imu/device_clock.h"
#include "drivers/imu/imu_mounting.h"
#include "drivers/imu/mip.h"
#include "tests/drivers/fuzz/fuzz_stream.h"
#include "tools/hil/emulated/mip_device.h"

namespace {

std::vector<std::uint8_t> sealed(sandrunner::Bytes bare) {
  namespace mip = sandrunner::mip;
  std::vector<std::uint8_t> stream;
  while (bare.size() >= 2) {
    const std::size_t length = std::min<std::size_t>(bare[1], bare.size() - 2);
    std::vector<std::uint8_t> packet{mip::kSync1, mip::kSync2, bare[0],
                                     static_cast<std::uint8_t>(length)};
    packet.insert(packet.end(), bare.begin() + 2, bare.begin() + 2 + length);
    const auto sum = mip::checksum(packet);
    packet.insert(packet.end(), sum.begin(), sum.end());
    stream.insert(stream.end(), packet.begin(), packet.end());
    bare = bare.subspan(2 + length);
  }
  return stream;
}

}  // namespace

/// The first byte is the size of the chunks in which the rest is read. Where it is odd, the rest is
/// taken as bare packets, descriptor set, length and payload, that are given their sync bytes and
/// checksum here: what lies behind a good checksum is else hardly reached.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace sandrunner;  // NOLINT(google-build-using-namespace)
  if (size == 0) return 0;
  const std::size_t chunk = 1 + bytes[0];
  std::vector<std::uint8_t> stream(bytes + 1, bytes + size);
  if (chunk % 2 == 0) stream = sealed(stream);

  mip::Parser parser;
  DeviceClock clock;
  const ImuMounting mounting = ImuMounting::from_rpy({0.4, -1.1, 2.0});
  std::array<double, 4> orientation{1.0, 0.0, 0.0, 0.0};
  std::uint64_t packet_bytes = 0;
  std::int64_t now_ns = 0, sample_ns = 0;
  const auto take = [&](const mip::PacketView& packet) {
    packet_bytes += mip::kHeaderSize + packet.payload.size() + mip::kChecksumSize;
    must(packet.first_byte_ns <= now_ns);
    if (const auto reply = mip::find_reply(packet.payload, mip::kBaseRate)) {
      must(mip::ack_text(reply->code) != nullptr);
    }
    const mip::SensorData data = mip::decode_sensor_data(packet.payload);
    const ImuReading reading = to_reading(data);
    if (reading.orientation_wxyz) {
      orientation = mounting.to_orientation(*reading.orientation_wxyz, orientation);
    }
    if (reading.acceleration_mps2) mounting.to_body(*reading.acceleration_mps2);
    if (data.reference_time_ns) {
      const std::int64_t taken_ns = clock.update(*data.reference_time_ns, packet.first_byte_ns);
      must(taken_ns >= sample_ns && taken_ns <= packet.first_byte_ns);
      sample_ns = taken_ns;
    }
    // What was decoded is encoded and decoded to the same.
    const mip::Packet again = mip::encode_sensor_data(data);
    must(again.bytes().size() ==
         mip::encode_sensor_data(mip::decode_sensor_data(again.payload())).bytes().size());
  };
  feed_in_chunks(parser, stream, chunk, now_ns, take);
  // Every byte is in a packet, was skipped, or waits for the rest of its packet.
  must(packet_bytes + parser.skipped_bytes() <= stream.size());
  must(packet_bytes + parser.skipped_bytes() + mip::kMaxPacket > stream.size());

  mip::Device device(1000, 921600);
  device.receive(stream);
  device.tick({});
  return 0;
}
