// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "rt/base/worker_pool.h"
#include "sim/batch/batch.h"
#include "sim/robot/robot_model.h"
#include "tools/python/checks.h"

namespace sandrunner::python {

/// The simulator without a task: robots on their ground, with all that C++ knows of each.
class Robots {
 public:
  /// `robot`: as sim::load_robot takes it. `ground`: a preset or terrain file; `settings`:
  /// PATH=VALUE of its table. Robots stand in their nominal pose. Throws InputError.
  Robots(const std::string& robot, int count, const std::string& ground,
         const std::vector<std::string>& settings, double step_hz, int threads);

  /// Puts robots of these indices on other ground; their feet forget what they stood on.
  void set_ground(const std::string& ground, const std::vector<std::string>& settings,
                  const std::vector<int>& robots);
  /// Checked: finite numbers, and a patch of ground that there is. Throws InputError.
  void set_state(int robot, const sim::RobotState<float>& state);
  void set_model(int robot, const sim::RobotModel<float>& model);
  /// As after the construction.
  void stand(const std::vector<int>& robots);

  /// Advances all robots by this many steps with the drives as they are in `drives`, and fills the
  /// other arrays. Throws InputError for a drive that is not finite.
  void advance(int ticks);

  int count() const { return batch_.size(); }
  std::vector<sim::RobotState<float>>& states() { return states_; }
  std::vector<sim::BatchDrive<float>>& drives() { return drives_; }
  std::vector<sim::BatchReport<float>>& reports() { return reports_; }
  std::vector<sim::BatchSums<float>>& sums() { return sums_; }
  std::vector<sim::RobotModel<float>> models() const;
  const sim::Robot& robot() const { return robot_; }
  std::atomic<bool>& busy() { return busy_; }

 private:
  void require_robot(int robot) const;

  sim::Robot robot_;
  sim::FootProfile<double> foot_;
  sim::Batch batch_;
  WorkerPool pool_;
  OwnProcess process_;
  std::vector<sim::RobotState<float>> states_;
  std::vector<sim::BatchDrive<float>> drives_;
  std::vector<sim::BatchReport<float>> reports_;
  std::vector<sim::BatchSums<float>> sums_;
  std::vector<std::shared_ptr<const sim::HeightGrid>> heights_;  // of each robot's ground
  std::vector<std::unique_ptr<sim::Footprints>> prints_;         // where it keeps them
  std::atomic<bool> busy_ = false;
};

}  // namespace sandrunner::python
