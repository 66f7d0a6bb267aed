// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recorder.h"

#include <utility>

#include "rt/telemetry/mcap/mcap_writer.h"

namespace sandrunner {
namespace {

constexpr std::size_t kBatchTicks = 40;
constexpr std::size_t kQueuedBatches = 200;  // two seconds

}  // namespace

Recorder::Recorder(const std::string& path, RecordingInfo info, const RecordingLimits& limits,
                   bool wait)
    : path_(path),
      limits_(limits),
      info_(std::move(info)),
      queue_(kBatchTicks, kQueuedBatches, wait) {
  McapWriter::try_path(path_);
  thread_ = std::thread([this] { work(); });
}

Recorder::~Recorder() { close(); }

RecordingResult Recorder::close() {
  if (thread_.joinable()) {
    queue_.finish();
    thread_.join();
    result_.dropped = queue_.dropped();
    if (writer_) result_.bytes = writer_->bytes_written();
  }
  return result_;
}

void Recorder::work() {
  while (const std::optional<TickQueue::Batch> batch = queue_.take()) {
    if (stopped_) continue;
    try {
      write(*batch);
    } catch (const std::exception& error) {  // also a lack of memory: the run itself goes on
      stop(error.what());
    }
  }
  try {
    if (writer_) writer_->close();
  } catch (const std::exception& error) {
    stop(error.what());
  }
}

void Recorder::write(const TickQueue::Batch& batch) {
  if (!writer_) writer_.emplace(path_, info_);
  writer_->write(batch);
  result_.ticks += batch.size();
  if (writer_->bytes_written() > limits_.bytes) stop("its size reached the limit");
  const std::uint64_t first = batch.front().input.sensors.tick;
  if (static_cast<double>(first) * kControlPeriod_s > limits_.time_s) {
    stop("its duration reached the limit");
  }
}

void Recorder::stop(const std::string& reason) {
  if (stopped_) return;
  stopped_ = true;
  result_.stopped_because = reason;
  try {
    if (writer_) writer_->close();
  } catch (const std::exception&) {  // the disk is full: what was written is readable
  }
}

}  // namespace sandrunner
