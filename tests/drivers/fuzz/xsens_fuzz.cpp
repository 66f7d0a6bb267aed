// SPDX-License-Identifier: BSD-3-Clause
// Any bytes on the serial line of an Xsens sensor: the parser, the decoder, the sensor's clock, and
// the emulated device.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/imu/imu_reading.h"
#include "drivers/imu/xsens.h"
#include "tests/drivers/fuzz/fuzz_stream.h"
#include "tools/hil/emulated/xsens_device.h"

namespace {

using sandrunner::Bytes;

/// The bytes as messages, identifier, two bytes of length and data each.
std::vector<std::uint8_t> sealed(Bytes bare) {
  std::vector<std::uint8_t> stream;
  while (bare.size() >= 3) {
    const std::size_t wanted = sandrunner::read_u16(bare, 1) % (sandrunner::xsens::kMaxData + 1);
    const std::size_t length = std::min(wanted, bare.size() - 3);
    const sandrunner::xsens::Message message(bare[0], bare.subspan(3, length));
    stream.insert(stream.end(), message.bytes().begin(), message.bytes().end());
    bare = bare.subspan(3 + length);
  }
  return stream;
}

bool same_bytes(Bytes a, Bytes b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

}  // namespace

/// The first byte is the size of the chunks in which the rest is read. Where it is odd, the rest is
/// taken as bare messages that are given their frame and checksum here: what lies behind a good
/// checksum is else hardly reached.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace sandrunner;  // NOLINT(google-build-using-namespace)
  if (size == 0) return 0;
  const std::size_t chunk = 1 + bytes[0];
  std::vector<std::uint8_t> stream(bytes + 1, bytes + size);
  if (chunk % 2 == 0) stream = sealed(stream);

  xsens::Parser parser;
  xsens::SampleClock clock;
  std::uint64_t message_bytes = 0;
  std::int64_t now_ns = 0;
  const auto take = [&](const xsens::MessageView& view) {
    must(view.first_byte_ns <= now_ns && view.data.size() <= xsens::kMaxData);
    // What was found is what would be sent, but for a short length in its long form: refused.
    const xsens::Message message(view.id, view.data);
    must(same_bytes(message.data(), view.data));
    message_bytes += message.bytes().size();
    if (!view.data.empty()) must(xsens::error_text(view.data[0]) != nullptr);
    const xsens::SensorData data = xsens::decode_sensor_data(view.data);
    if (data.sample_time) clock.update(*data.sample_time);
    // What was decoded is encoded to the same, and so are its axes there and back; bytes are
    // compared, as numbers may be none.
    const xsens::Message again = xsens::encode_sensor_data(data);
    const xsens::SensorData decoded = xsens::decode_sensor_data(again.data());
    must(same_bytes(xsens::encode_sensor_data(decoded).bytes(), again.bytes()));
    must(decoded.unknown_fields == 0 && decoded.wrong_length_fields == 0);
    const ImuReading reading = to_reading(data);
    must(reading.orientation_wxyz.has_value() == data.quaternion_wxyz.has_value());
    to_xsens(reading);
  };
  feed_in_chunks(parser, stream, chunk, now_ns, take);
  // Every byte is in a message, was skipped, or waits for the rest of its message.
  must(message_bytes + parser.skipped_bytes() <= stream.size());
  must(message_bytes + parser.skipped_bytes() + xsens::kMaxMessage > stream.size());

  xsens::Device device(400, 921600);
  device.receive(stream);
  ImuReading reading;
  reading.device_ns = 1;
  reading.orientation_wxyz = {1.0, 0.0, 0.0, 0.0};
  for (int i = 0; i < 5; ++i) device.tick(reading);
  return 0;
}
