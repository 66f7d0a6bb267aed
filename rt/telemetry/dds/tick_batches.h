// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "rt/loop/tick_record.h"
#include "rt/telemetry/dds/participant.h"

namespace sandrunner {

/// Ticks of one message on sandrunner/ticks: 10 ms.
inline constexpr std::uint32_t kTicksPerBatch = 40;
/// Messages that are kept for a subscriber that is late: 2 s.
inline constexpr int kBatchDepth = 200;

/// Publishes every tick, 40 a message, the messages numbered without a gap.
class TickBatches {
 public:
  /// Throws InputError.
  explicit TickBatches(const DdsParticipant& participant);
  ~TickBatches();

  /// `stamp_ns` since 1970, of this tick. False: a message was due and could not be written.
  bool add(const TickRecord& tick, std::int64_t stamp_ns);
  /// Writes what is left, for the end. False: that failed.
  bool flush();

 private:
  struct Batch;
  std::unique_ptr<Batch> batch_;
};

}  // namespace sandrunner
