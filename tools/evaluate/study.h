// SPDX-License-Identifier: BSD-3-Clause
// What is run: parts of groups of trials. The same trials for every policy.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "sim/ground/terrain_description.h"
#include "tools/evaluate/trial.h"

namespace sandrunner::evaluate {

struct StudySettings {
  int runs = 16;        ///< of a group, besides the grid's
  int grid_runs = 360;  ///< of a cell of the stiffness grid (paper, "Evaluation in simulation")
  std::uint64_t seed = 1;
};

/// Trials that differ only in start and random numbers.
struct Group {
  std::string ground;    ///< preset, or what it is
  std::string scenario;  ///< empty: nothing special
  VelocityCommand command;
  double sigma_flat_npm3 = 0.0, sigma_cone_npm3 = 0.0;  ///< of the stiffness grid
  std::vector<Trial> trials;
};

/// "straight", "grid", "turn", "robust", "beyond" or "commands".
struct Part {
  std::string name;
  std::vector<Group> groups;
};

/// The maps of commands: vx across, vy or yaw rate up.
enum class CommandPlane { kSideways, kTurning };
inline constexpr int kCommandColumns = 13, kCommandRows = 9;
inline constexpr double kCommandAcceleration = 2.0;  ///< of the commands, m/s^2 and rad/s^2
double commanded_vx_mps(int column);
double commanded_other(CommandPlane plane, int row);  ///< m/s or rad/s

inline constexpr int kGridSize = 10;  ///< cells along each side of the stiffness grid

/// Robot, grounds and starts, to which trials point: it must outlive them, at its place.
class Study {
 public:
  Study(const StudySettings& settings, const sim::Robot& robot);
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;

  const sim::Robot& robot() const noexcept { return robot_; }
  const sim::FootProfile<double>& foot() const noexcept { return foot_; }

  /// Keeps a ground for trials.
  const sim::Terrain<float>* add(const sim::TerrainDescription& terrain);
  /// The state in which run i starts: run 0 in the nominal pose, the others disturbed, as
  /// `sandrunner --start walk --seed` does with the seeds 0, 1, 2, ... for the default seed 1.
  const sim::RobotState<float>& start(int run) const { return starts_.at(run); }
  /// The same on ground that is not level: square on its plane, as the simulator starts there.
  const sim::RobotState<float>& start_on(const sim::TerrainDescription& terrain, int run);
  /// Number of run i for its noise, pushes and random command.
  std::uint64_t run_seed(int run) const noexcept;
  /// A group of StudySettings::runs trials like this one.
  Group group(const std::string& ground, const std::string& scenario, const Trial& like) const;

  Part straight();
  Part grid();
  Part turn();
  Part robust();
  Part beyond();
  Part commands();

 private:
  StudySettings settings_;
  sim::Robot robot_;
  sim::FootProfile<double> foot_;
  std::deque<sim::Terrain<float>> terrains_;
  std::deque<sim::RobotState<float>> starts_;  // the level ones first
};

struct PartRow {
  const char* name;
  Part (Study::*make)();
};
/// All parts, in the order in which they run.
inline constexpr PartRow kParts[] = {
    {"straight", &Study::straight}, {"grid", &Study::grid},     {"turn", &Study::turn},
    {"robust", &Study::robust},     {"beyond", &Study::beyond}, {"commands", &Study::commands}};

}  // namespace sandrunner::evaluate
