// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "rt/dds/participant.h"
#include "tools/ctl/robot_view.h"

namespace sandrunner::ctl {

/// Feeds a RobotView from DDS.
class ViewReader {
 public:
  /// Throws InputError.
  explicit ViewReader(const DdsParticipant& participant);

  /// Adds everything that has arrived.
  void take_into(RobotView& view);

 private:
  std::array<dds_entity_t, RobotView::kNumRates> readers_;  // by RobotView::Rate
};

}  // namespace sandrunner::ctl
