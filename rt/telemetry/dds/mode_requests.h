// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "rt/core/messages.h"

namespace sandrunner {

/// What an operator may ask for over DDS, by name.
enum class Wish { kStand, kWalk, kStop, kDamp, kResetFault };

/// "stand", "walk", "stop", "damp", "reset_fault"; nothing for another text.
std::optional<Wish> wish_from(std::string_view text) noexcept;

/// What to do about a wish.
struct WishDecision {
  ModeRequest request = ModeRequest::kNone;  ///< to be passed on; kNone: nothing
  const char* refusal = nullptr;             ///< why not; null: accepted
};

/// Decides in `mode`. Stop is the controlled stop of a walking robot and else nothing: it makes no
/// robot stand up. `can_walk`: there is a policy.
WishDecision decide(Wish wish, Mode mode, bool can_walk) noexcept;

/// Why a wish that was passed on did not come true, judged by the mode after it; null: it did.
const char* failure(Wish wish, Mode after) noexcept;

}  // namespace sandrunner
