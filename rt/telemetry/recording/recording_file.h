// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "rt/loop/replay.h"
#include "rt/telemetry/recording/recording_writer.h"

namespace sandrunner {

/// What a recording contains besides its ticks.
struct RecordingContents {
  RecordingInfo info;
  bool complete = false;  ///< false: truncated, and read up to its last whole chunk
  std::string damage;     ///< the first that was found, one line; empty: none
  std::uint64_t ticks = 0;
  std::uint64_t lost = 0;  ///< ticks that the recorder of the run lost between those
};

/// What takes the content of a recording, in order; each may be empty.
struct RecordingVisitor {
  std::function<void(const RecordingInfo&)> begin;  ///< once, before everything else
  std::function<bool(const TickRecord&)> tick;      ///< false: enough
  /// The file lacks the ticks from the first to the second; nothing in its place: all to the end.
  /// `by_damage`: of the file; else the recorder of the run lost them.
  std::function<void(std::uint64_t, std::optional<std::uint64_t>, bool by_damage)> lost;
  std::function<void(const ReplayState&)> state;  ///< before the tick that follows
  /// What happened in or before a tick: kind and text. It may come up to some seconds early.
  std::function<void(std::uint64_t, const std::string&, const std::string&)> event;
};

/// Reads a recording from its start. Damage behind the beginning costs the ticks of its chunk: it
/// is noted, and reading goes on with the next one. Throws InputError if the file is not one of our
/// recordings, its beginning is damaged, or it does not begin with the tick that it names.
RecordingContents read_recording(const std::string& path, const RecordingVisitor& visitor);

}  // namespace sandrunner
