// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sandrunner {

/// How hard a page pushes.
inline constexpr double kPush_mps = 0.5;

using GroundSettings = std::vector<std::pair<std::string, double>>;  ///< keys without "terrain."

/// The ground as a page asks for it: a preset, and settings of [terrain] in place of its own.
struct WantedGround {
  std::string preset;  ///< empty: as the run began
  GroundSettings set;
};

/// The ground as it is.
struct GroundNow {
  WantedGround wanted;  ///< as it was asked for
  std::string name;
  std::string kind;                  ///< its word in terrain.kind
  bool granular = false;             ///< drawn as sand
  std::vector<std::string> presets;  ///< that there are
  GroundSettings values;             ///< of all that can be set
};

/// What pages do to a simulated robot and its ground between two ticks. Called by the server's
/// thread; what is asked is done before the next tick. Each returns why not, in one line; empty: it
/// will be.
class ViewControl {
 public:
  virtual ~ViewControl() = default;
  /// kPush_mps more speed towards `direction_rad` from world x.
  virtual std::string push(double direction_rad) = 0;
  virtual std::string set_on_legs() = 0;
  virtual std::string set_ground(const WantedGround& wanted) = 0;
  virtual GroundNow ground() const = 0;
};

}  // namespace sandrunner
