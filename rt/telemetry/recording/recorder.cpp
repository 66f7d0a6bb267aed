// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recorder.h"

#include <unistd.h>

#include <utility>

#include "rt/core/floating_point.h"
#include "rt/telemetry/mcap/mcap_writer.h"

namespace sandrunner {
namespace {

constexpr std::size_t kQueuedBatches = 200;  // two seconds

}  // namespace

Recorder::Recorder(const std::string& path, RecordingInfo info, const RecordingLimits& limits,
                   bool wait, const ControllerConfig* config, PolicyRunner policy)
    : path_(path),
      limits_(limits),
      info_(std::move(info)),
      queue_(kTicksPerMessage, kQueuedBatches, wait) {
  if (config) replay_.emplace(*config, start_mode_of(info_), std::move(policy));
  McapWriter::try_path(path_);
  thread_ = std::thread([this] { work(); });
}

Recorder::~Recorder() { Recorder::end(); }

void Recorder::note(std::uint64_t tick, const std::string& kind, const std::string& text) {
  const std::lock_guard lock(notes_mutex_);
  notes_.push_back({tick, kind, text});
}

void Recorder::end() {
  if (thread_.joinable()) {
    queue_.finish();
    thread_.join();
    result_.dropped = queue_.dropped();
    if (writer_) result_.bytes = writer_->bytes_written();
    result_.removed = writer_ && ::access(path_.c_str(), F_OK) != 0;
  }
}

void Recorder::work() {
  flush_denormals_to_zero();  // as where the ticks came from
  while (const std::optional<TickQueue::Batch> batch = queue_.take()) {
    if (stopped_) continue;
    try {
      write(*batch);
    } catch (const std::exception& error) {  // also a lack of memory: the run itself goes on
      stop(error.what(), true);
    }
  }
  try {
    if (writer_) writer_->close();
  } catch (const std::exception& error) {
    stop(error.what(), true);
  }
}

void Recorder::write(const TickQueue::Batch& batch) {
  if (!writer_) writer_.emplace(path_, info_);
  if (replay_ && writer_->bytes_written() != bytes_at_state_) write_state();
  write_notes();
  writer_->write(batch);
  // Behind lost ticks it differs too: no state is known there.
  for (const TickRecord& tick : batch) {
    if (replay_ && replay_->check(tick)) replay_.reset();
  }
  result_.ticks += batch.size();
  if (writer_->bytes_written() > limits_.bytes) stop("its size reached the limit", false);
  const std::uint64_t first = batch.front().input.sensors.tick;
  if (static_cast<double>(first) * kControlPeriod_s > limits_.time_s) {
    stop("its duration reached the limit", false);
  }
}

// What was noted by now is of this batch or, if the run is ahead of the disk, of a later one.
void Recorder::write_notes() {
  std::vector<Note> notes;
  {
    const std::lock_guard lock(notes_mutex_);
    notes.swap(notes_);
  }
  for (const Note& note : notes) writer_->write_event(note.tick, note.kind, note.text);
}

// The first message of ticks in a chunk comes behind it: bytes are written when a chunk ends.
void Recorder::write_state() {
  const ReplayState state = replay_->state();
  writer_->write_state(state.next_tick, replay_state_bytes(state));
  bytes_at_state_ = writer_->bytes_written();
}

void Recorder::stop(const std::string& reason, bool failed) {
  if (stopped_) return;
  stopped_ = true;
  result_.failed = failed;
  result_.stopped_because = reason;
  try {
    if (writer_) writer_->close();
  } catch (const std::exception&) {  // the disk is full: what was written is readable
  }
}

}  // namespace sandrunner
