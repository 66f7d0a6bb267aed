// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "rt/dds/participant.h"
#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Ticks in one message on sandrunner/ticks: 10 ms.
inline constexpr std::uint32_t kTicksPerBatch = 40;
/// Messages that are kept for a slow subscriber: 2 s.
inline constexpr int kBatchDepth = 200;

/// Publishes every tick, 40 to a message; the messages are numbered without gaps.
class TickBatches {
 public:
  /// Throws InputError.
  explicit TickBatches(const DdsParticipant& participant);
  ~TickBatches();

  /// `stamp_ns`: of this tick, since 1970. False: a message was due and could not be written.
  bool add(const TickRecord& tick, std::int64_t stamp_ns);
  /// Writes the ticks that are left at the end. False: they could not be written.
  bool flush();

 private:
  struct Batch;
  std::unique_ptr<Batch> batch_;
};

}  // namespace sandrunner
