// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/black_box.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <new>
#include <span>
#include <stdexcept>
#include <utility>

#include "rt/base/output_files.h"

namespace sandrunner {
namespace {

constexpr std::size_t kBlockTicks = 400;  // 0.1 s, 1 MB; longer blocks compress no better
constexpr int kCompressionLevel = 1;      // as in files

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

/// A file that is due.
struct BlackBox::File {
  File(BlackBoxFile facts_in, RecordingInfo info_in,
       std::deque<std::shared_ptr<const Block>> blocks_in)
      : facts(std::move(facts_in)), info(std::move(info_in)), blocks(std::move(blocks_in)) {}

  BlackBoxFile facts;
  RecordingInfo info;
  std::deque<std::shared_ptr<const Block>> blocks;  // still to be written; they outlive the window
  std::optional<WholeFile> whole;
  std::optional<RecordingWriter> writer;
  std::future<void> kept;  // a slow disk takes longer for this than the queue is deep

  // Writes the next block, or whatever else comes next; true: the file is done. Throws.
  bool advance() {
    if (!writer) {
      whole.emplace(facts.path);
      writer.emplace(whole->part_path(), info);
    } else if (!blocks.empty()) {
      write(*blocks.front());
      blocks.pop_front();
    } else if (!kept.valid()) {
      writer->close();
      kept = std::async(std::launch::async, [this] { whole->keep(); });
    } else if (kept.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      kept.get();
      return true;
    }
    return false;
  }

 private:
  void write(const Block& block) {
    if (!block.state.empty() && writer->wants_state()) {
      writer->write_state(block.first_tick, block.state);
    }
    writer->write(uncompressed(block.bytes, block.ticks));
  }
};

BlackBox::BlackBox(std::string folder, RecordingInfo info, double window_s)
    : folder_(std::move(folder)),
      info_(std::move(info)),
      kept_ticks_(ticks_from_s(window_s + kBlackBoxAfter_s)) {}

BlackBox::~BlackBox() = default;

template <typename Action>
void BlackBox::unless_out_of_memory(const Action& action) {
  if (!result_.stopped_because.empty()) return;
  try {
    action();
  } catch (const std::bad_alloc&) {  // locked memory is limited, and the run itself needs it more
    result_.stopped_because = "out of memory";
    window_.clear();
    files_.clear();
    open_ticks_ = {};
  }
}

void BlackBox::keep(const TickQueue::Batch& ticks, const std::optional<ReplayState>& before) {
  unless_out_of_memory([&] {
    if (open_ticks_.empty()) open_state_ = before ? replay_state_bytes(*before) : std::string();
    open_ticks_.insert(open_ticks_.end(), ticks.begin(), ticks.end());
    note_faults(ticks);
    if (open_ticks_.size() >= kBlockTicks) close_block();
    make_files(ticks_from_s(kBlackBoxAfter_s));
    write_some();
  });
}

void BlackBox::finish() {
  unless_out_of_memory([&] {
    close_block();
    make_files(0);
    while (!files_.empty()) {
      if (files_.front()->kept.valid()) files_.front()->kept.wait();
      write_some();
    }
  });
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

void BlackBox::close_block() {
  if (open_ticks_.empty()) return;
  newest_tick_ = open_ticks_.back().input.sensors.tick;
  window_.push_back(std::make_shared<const Block>(
      Block{open_ticks_.front().input.sensors.tick, newest_tick_, open_ticks_.size(),
            compressed(open_ticks_), std::move(open_state_)}));
  open_ticks_.clear();
  bytes_ += window_.back()->bytes.size();
  result_.peak_bytes = std::max(result_.peak_bytes, bytes_);
  while (window_.front()->last_tick + kept_ticks_ < newest_tick_) {
    bytes_ -= window_.front()->bytes.size();
    window_.pop_front();
  }
}

void BlackBox::make_files(std::uint64_t ticks_after) {
  for (; !marks_.empty() && newest_tick_ >= marks_.front().tick + ticks_after; marks_.pop_front()) {
    if (files_made_ == kBlackBoxFiles) {
      ++result_.left_out;
      continue;
    }
    const Mark& mark = marks_.front();
    const Block& first = *window_.front();
    RecordingInfo info = info_;
    info.first_tick = first.first_tick;
    if (info.first_tick > 0) info.state = first.state;
    const double before_s =
        (static_cast<double>(mark.tick) - static_cast<double>(info.first_tick)) * kControlPeriod_s;
    files_.push_back(std::make_unique<File>(
        BlackBoxFile{.fault = mark.fault,
                     .fault_tick = mark.tick,
                     .before_s = before_s,
                     .path = fmt::format("{}/black-box-{}.mcap", folder_, mark.tick),
                     .has_start = !first.state.empty(),
                     .problem = {}},
        std::move(info), window_));
    ++files_made_;
  }
}

void BlackBox::write_some() {
  if (files_.empty()) return;
  BlackBoxFile& facts = files_.front()->facts;
  try {
    if (!files_.front()->advance()) return;
  } catch (const std::bad_alloc&) {
    facts.problem = "out of memory";
  } catch (const std::runtime_error& error) {  // of the file, or a thread could not be started
    facts.problem = error.what();
  }
  result_.files.push_back(std::move(facts));
  files_.pop_front();
}

}  // namespace sandrunner
