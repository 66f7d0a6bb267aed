// SPDX-License-Identifier: BSD-3-Clause
// What the fuzz targets of the IMU's protocols have in common.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "drivers/imu/big_endian.h"

namespace sandrunner {

inline void must(bool holds) {
  if (!holds) std::abort();
}

/// Feeds the stream to a parser in chunks, one a control tick. `now_ns` is when the last one came.
template <typename Parser, typename Take>
void feed_in_chunks(Parser& parser, Bytes stream, std::size_t chunk, std::int64_t& now_ns,
                    Take&& take) {
  while (!stream.empty()) {
    const std::size_t size = std::min(chunk, stream.size());
    now_ns += 250'000;
    parser.feed(stream.first(size), now_ns, take);
    stream = stream.subspan(size);
  }
}

}  // namespace sandrunner
