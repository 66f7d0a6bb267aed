// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "rt/core/messages.h"

namespace sandrunner {

/// The names of kRequestTable for a message: "arm, stand, ... or reset_fault".
std::string request_names();

/// What to do about a request.
struct RequestDecision {
  ModeRequest request = ModeRequest::kNone;  ///< for the controller; kNone: there is nothing to do
  bool calms = false;                        ///< it ends the motion: stop and damp
  const char* refusal = nullptr;             ///< why not; null: accepted
};

/// Decides in `mode`; `name` is one of kRequestTable. "stop" ends every motion: a walking robot's
/// in a controlled stop, that of one on its way up or down in damping; it makes no robot stand up.
/// `no_walk`: why the robot may not walk; null: it may.
RequestDecision decide(std::string_view name, Mode mode, const char* no_walk) noexcept;

/// Whether a request of this name ends motion, in whatever mode.
bool calms(std::string_view name) noexcept;

/// Why a request had no effect, judged by the mode of the controller after it; null: it had.
const char* failure(ModeRequest request, Mode after) noexcept;

}  // namespace sandrunner
