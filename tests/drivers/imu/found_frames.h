// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "drivers/imu/big_endian.h"

namespace sandrunner {

using ByteVector = std::vector<std::uint8_t>;

inline ByteVector operator+(ByteVector a, const ByteVector& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// All bytes of a packet or message.
template <typename Frame>
ByteVector bytes_of(const Frame& frame) {
  return {frame.bytes().begin(), frame.bytes().end()};
}

/// What a parser finds in a stream that is given to it in chunks of one size.
template <typename Parser>
struct FoundFrames {
  explicit FoundFrames(Bytes stream = {}, std::size_t chunk = SIZE_MAX) {
    for (; !stream.empty(); stream = stream.subspan(std::min(chunk, stream.size()))) {
      feed(stream.first(std::min(chunk, stream.size())));
    }
  }
  void feed(Bytes bytes, std::int64_t time_ns = 0) {
    parser.feed(bytes, time_ns, [this](const auto& frame) {
      const auto& [kind, data, first_byte_ns] = frame;
      kinds.push_back(kind);
      datas.emplace_back(data.begin(), data.end());
      times_ns.push_back(first_byte_ns);
    });
  }
  Parser parser;
  ByteVector kinds;  ///< of each its descriptor set or identifier
  std::vector<ByteVector> datas;
  std::vector<std::int64_t> times_ns;  ///< of their first bytes
};

}  // namespace sandrunner
