// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rt/core/robot_description.h"
#include "rt/report/run_record.h"
#include "rt/telemetry/view/view_frame.h"

namespace sandrunner {

/// What a run may cost in memory, and its page on the disk.
struct ViewPageLimits {
  std::size_t frames = 80'000;
  std::size_t bytes = 16'000'000;
};

/// run.html: a run as a page that opens from a disk, with all that it needs in it. Ordinary
/// threads. Longer runs are shown at 50, then at 25 frames a second; of still longer ones, the page
/// has the last part. It says so.
class ViewPage {
 public:
  ViewPage(RunScene scene, const RobotDescription& robot, const ViewPageLimits& limits = {});

  /// Every tick, in order.
  void add(const TickRecord& tick);

  /// After the last tick. `curve`: a learning curve that is drawn above the run, as JSON: {title,
  /// x_label, x: [...], every: rows that each value is the mean of, charts: [{title, unit, lines:
  /// [{name, values: [...]}]}]}; empty: none.
  std::string html(std::string_view curve = {});

 private:
  void add_frame(ViewFrame frame);
  /// Every second frame, or where that would be too few, the younger three quarters.
  void keep_less();
  std::string note() const;
  std::string page_of_all(std::string_view curve) const;

  const RunScene scene_;
  const RobotDescription robot_;
  const ViewPageLimits limits_;
  ViewFrameMaker maker_;
  std::vector<ViewFrame> frames_;
  std::vector<ViewFootprint> footprints_;
  std::size_t stride_ = 1;  // of the frames that are kept
  std::optional<ViewFrame> left_out_;
  std::size_t since_kept_ = 0;
  bool begins_later_ = false;
};

}  // namespace sandrunner
