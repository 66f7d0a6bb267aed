// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "rt/telemetry/recording/recording_writer.h"

namespace sandrunner {

/// What a recording contains besides its ticks.
struct RecordingContents {
  RecordingInfo info;
  bool complete = false;  ///< false: truncated, and read up to its last whole chunk
  std::uint64_t ticks = 0;
};

/// Reads a recording from its start. `tick` is called for each tick, in order, until it returns
/// false; `begin`, if given, once before the first. Throws InputError if the file is not one of our
/// recordings or is damaged.
RecordingContents read_recording(const std::string& path,
                                 const std::function<void(const RecordingInfo&)>& begin,
                                 const std::function<bool(const TickRecord&)>& tick);

}  // namespace sandrunner
