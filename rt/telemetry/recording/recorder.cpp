// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recorder.h"

#include <unistd.h>

#include <exception>
#include <utility>

#include "rt/telemetry/mcap/mcap_writer.h"

namespace sandrunner {

Recorder::Recorder(const std::string& path, RecordingInfo info, const RecordingLimits& limits)
    : path_(path), limits_(limits), info_(std::move(info)) {
  McapWriter::try_path(path_);
}

void Recorder::note(std::uint64_t tick, const std::string& kind, const std::string& text) {
  const std::lock_guard lock(notes_mutex_);
  notes_.push_back({tick, kind, text});
}

void Recorder::keep(const TickQueue::Batch& ticks, const std::optional<ReplayState>& before) {
  if (stopped_) return;
  try {
    write(ticks, before);
  } catch (const std::exception& error) {  // also a lack of memory: the run itself goes on
    stop(error.what(), true);
  }
}

void Recorder::finish() {
  if (!writer_) return;
  try {
    writer_->close();
  } catch (const std::exception& error) {
    stop(error.what(), true);
  }
  result_.bytes = writer_->bytes_written();
  result_.removed = ::access(path_.c_str(), F_OK) != 0;
}

void Recorder::write(const TickQueue::Batch& batch, const std::optional<ReplayState>& before) {
  if (!writer_) writer_.emplace(path_, info_);
  if (before && writer_->wants_state()) {
    writer_->write_state(before->next_tick, replay_state_bytes(*before));
  }
  write_notes();
  writer_->write(batch);
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
