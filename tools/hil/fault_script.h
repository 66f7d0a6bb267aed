// SPDX-License-Identifier: BSD-3-Clause
// Faults that the bench is to make, as a person writes them: "2.5 silent LF_KFE".
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sandrunner::hil {

/// What follows a kind's name.
enum class Takes : std::uint8_t { kNothing, kNumber, kJoint, kJointAndNumber, kTwoJoints, kBus };

/// A kind of fault.
struct FaultKind {
  const char* name;
  Takes takes;
  const char* help;
};

/// The words of a robot's scripts.
struct FaultWords {
  std::vector<FaultKind> kinds;
  std::span<const std::string> joints;
  std::vector<std::string> buses;
};

/// One line of a script.
struct TimedFault {
  std::string text;  ///< as it was written
  std::string kind;
  /// s since all drives were first on together, or since the bench began.
  double at_s = 0.0;
  bool from_start = false;
  int first = 0, second = 0;  ///< joint or bus; the other joint
  double value = 0.0;
};

/// Reads "T KIND [JOINT|INTERFACE] [JOINT|NUMBER]", T a number, "start" or "start+NUMBER". Throws
/// InputError.
TimedFault read_fault(const std::string& text, const FaultWords& words);

/// A kind of fault that a link `L` makes.
template <typename L>
struct LinkFault : FaultKind {
  void (*make)(L& link, const TimedFault& fault);
};

/// Makes the fault; false: it is of none of these kinds.
template <typename L>
bool make_fault(std::span<const LinkFault<L>> kinds, L& link, const TimedFault& fault) {
  const auto kind = std::ranges::find(kinds, fault.kind, &LinkFault<L>::name);
  if (kind == kinds.end()) return false;
  kind->make(link, fault);
  return true;
}

}  // namespace sandrunner::hil
