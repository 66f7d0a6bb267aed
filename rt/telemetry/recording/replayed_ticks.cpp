// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/replayed_ticks.h"

#include <new>
#include <utility>

#include "rt/core/processor.h"
#include "rt/telemetry/recording/recording_writer.h"

namespace sandrunner {
namespace {

constexpr std::size_t kQueuedBatches = 200;  // two seconds

}  // namespace

ReplayedTicks::ReplayedTicks(const ControllerConfig& config, Mode start, PolicyRunner policy,
                             WhenFull when_full, std::vector<TickKeeper*> keepers)
    : queue_(kTicksPerMessage, kQueuedBatches, when_full),
      keepers_(std::move(keepers)),
      replay_(config, start, std::move(policy)) {
  thread_ = std::thread([this] { work(); });
}

ReplayedTicks::~ReplayedTicks() { ReplayedTicks::end(); }

void ReplayedTicks::begin(std::int64_t start_ns) {
  for (TickKeeper* keeper : keepers_) keeper->begin(start_ns);
}

void ReplayedTicks::note(std::uint64_t tick, const std::string& kind, const std::string& text) {
  for (TickKeeper* keeper : keepers_) keeper->note(tick, kind, text);
}

void ReplayedTicks::end() {
  if (!thread_.joinable()) return;
  queue_.finish();
  thread_.join();
  result_.dropped = queue_.dropped();
}

void ReplayedTicks::work() {
  flush_denormals_to_zero();  // as where the ticks came from
  while (const std::optional<TickQueue::Batch> batch = queue_.take()) {
    const std::optional<ReplayState> before = state_before(batch->front());
    for (TickKeeper* keeper : keepers_) keeper->keep(*batch, before);
    check(*batch);
  }
  for (TickKeeper* keeper : keepers_) keeper->finish();
}

std::optional<ReplayState> ReplayedTicks::state_before(const TickRecord& first) {
  if (!in_step()) return std::nullopt;
  if (missing_before(first, replay_.next_tick()) == 0) return replay_.state();
  result_.lost_from = replay_.next_tick();
  return std::nullopt;
}

void ReplayedTicks::check(const TickQueue::Batch& batch) {
  try {
    for (const TickRecord& tick : batch) {
      if (!in_step()) return;
      if (missing_before(tick, replay_.next_tick()) > 0) {
        result_.lost_from = replay_.next_tick();
      } else {
        result_.difference = replay_.check(tick);
      }
    }
  } catch (const std::bad_alloc&) {  // locked memory is limited, and the run itself needs it more
    result_.lost_from = replay_.next_tick();
  }
}

}  // namespace sandrunner
