// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/black_box.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <new>
#include <span>
#include <utility>

#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/core/floating_point.h"

namespace sandrunner {
namespace {

constexpr std::size_t kBlockTicks = 400;   // 0.1 s, 1 MB; longer blocks compress no better
constexpr std::size_t kQueuedBlocks = 20;  // two seconds
constexpr int kCompressionLevel = 1;       // as in files

std::vector<std::byte> compressed(std::span<const TickRecord> ticks) {
  std::vector<std::byte> room(ZSTD_compressBound(ticks.size_bytes()));
  const std::size_t size =
      ZSTD_compress(room.data(), room.size(), ticks.data(), ticks.size_bytes(), kCompressionLevel);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // the output fits: only memory can fail
  return {room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size)};
}

TickQueue::Batch uncompressed(std::span<const std::byte> bytes, std::size_t ticks) {
  TickQueue::Batch batch(ticks);
  const std::size_t size =
      ZSTD_decompress(batch.data(), ticks * sizeof(TickRecord), bytes.data(), bytes.size());
  if (size != ticks * sizeof(TickRecord)) throw std::bad_alloc();
  return batch;
}

}  // namespace

BlackBox::BlackBox(std::string folder, RecordingInfo info, const ControllerConfig& config,
                   PolicyRunner policy, double window_s, bool wait)
    : folder_(std::move(folder)),
      info_(std::move(info)),
      kept_ticks_(ticks_from_s(window_s + kBlackBoxAfter_s)),
      queue_(kBlockTicks, kQueuedBlocks, wait),
      replay_(config, start_mode_of(info_), std::move(policy)) {
  thread_ = std::thread([this] { work(); });
}

BlackBox::~BlackBox() { BlackBox::end(); }

void BlackBox::end() {
  if (thread_.joinable()) {
    queue_.finish();
    thread_.join();
    result_.dropped = queue_.dropped();
  }
}

void BlackBox::work() {
  flush_denormals_to_zero();
  try {
    while (const std::optional<TickQueue::Batch> batch = queue_.take()) {
      keep(*batch);
      write_marked(ticks_from_s(kBlackBoxAfter_s));
    }
    write_marked(0);
  } catch (const std::bad_alloc&) {  // locked memory is limited, and the run itself needs it more
    result_.stopped_because = "out of memory";
    window_.clear();
    while (queue_.take()) {
    }
  }
}

void BlackBox::keep(const TickQueue::Batch& batch) {
  note_faults(batch);
  newest_tick_ = batch.back().input.sensors.tick;
  window_.push_back(
      std::make_shared<const Block>(Block{batch.front().input.sensors.tick, newest_tick_,
                                          batch.size(), compressed(batch), replay(batch)}));
  bytes_ += window_.back()->bytes.size();
  result_.peak_bytes = std::max(result_.peak_bytes, bytes_);
  while (window_.front()->last_tick + kept_ticks_ < newest_tick_) {
    bytes_ -= window_.front()->bytes.size();
    window_.pop_front();
  }
}

void BlackBox::note_faults(const TickQueue::Batch& batch) {
  for (const TickRecord& tick : batch) {
    const std::uint64_t faults = tick.output.faults;
    // Faults that latch after the first belong to the same fall.
    if (faults != 0 && last_faults_ == 0) {
      marks_.push_back({tick.output.first_fault, tick.input.sensors.tick});
    }
    last_faults_ = faults;
  }
}

// Returns the state before these ticks.
std::string BlackBox::replay(const TickQueue::Batch& batch) {
  if (result_.difference || result_.lost_from) return {};  // no replay gets past them
  std::string state = replay_state_bytes(replay_.state());
  for (const TickRecord& tick : batch) {
    if (missing_before(tick, replay_.next_tick()) > 0) {
      result_.lost_from = replay_.next_tick();
      return &tick == &batch.front() ? std::string() : state;
    }
    result_.difference = replay_.check(tick);
    if (result_.difference) break;
  }
  return state;
}

void BlackBox::write_marked(std::uint64_t ticks_after) {
  while (!marks_.empty() && newest_tick_ >= marks_.front().tick + ticks_after) {
    const Mark mark = marks_.front();
    marks_.pop_front();
    if (result_.files.size() < kBlackBoxFiles) {
      write(mark);
    } else {
      ++result_.left_out;
    }
  }
}

void BlackBox::write(const Mark& mark) {
  const Block& first = *window_.front();
  BlackBoxFile file;
  file.fault = mark.fault;
  file.fault_tick = mark.tick;
  file.path = fmt::format("{}/black-box-{}.mcap", folder_, mark.tick);
  file.has_start = !first.state.empty();
  RecordingInfo info = info_;
  info.first_tick = first.first_tick;
  if (info.first_tick > 0) info.state = first.state;
  file.before_s =
      (static_cast<double>(mark.tick) - static_cast<double>(info.first_tick)) * kControlPeriod_s;
  try {
    WholeFile whole(file.path);
    write_recording(whole.part_path(), info);
    // A slow disk takes longer for this than the queue is deep.
    std::future<void> kept = std::async(std::launch::async, [&] { whole.keep(); });
    while (kept.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) {
      keep_queued();
    }
    kept.get();
  } catch (const std::bad_alloc&) {
    file.problem = "out of memory";
  } catch (const std::runtime_error& error) {  // of the file, or of a thread that was not to be had
    file.problem = error.what();
  }
  result_.files.push_back(std::move(file));
}

void BlackBox::write_recording(const std::string& path, const RecordingInfo& info) {
  RecordingWriter writer(path, info);
  // The run goes on meanwhile, and the disk may be slow: these blocks outlive the window.
  const std::vector<std::shared_ptr<const Block>> blocks(window_.begin(), window_.end());
  std::uint64_t bytes_at_state = 0;
  for (const std::shared_ptr<const Block>& block : blocks) {
    // The first in a chunk: none is needed behind ticks that can be read.
    if (!block->state.empty() && writer.bytes_written() != bytes_at_state) {
      writer.write_state(block->first_tick, block->state);
      bytes_at_state = writer.bytes_written();
    }
    writer.write(uncompressed(block->bytes, block->ticks));
    keep_queued();
  }
  writer.close();
}

void BlackBox::keep_queued() {
  while (const std::optional<TickQueue::Batch> batch = queue_.take_at_once()) keep(*batch);
}

}  // namespace sandrunner
