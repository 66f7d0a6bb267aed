// SPDX-License-Identifier: BSD-3-Clause
// The runs of a page, in the module and, for tests, natively: no file, thread or exception in it.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rt/loop/lockstep.h"
#include "rt/operator/remote_operator.h"
#include "rt/operator/return_to_stand.h"
#include "rt/report/row_maker.h"
#include "rt/run/command_source.h"
#include "rt/run/run_script.h"
#include "rt/telemetry/view/view_tiles.h"
#include "tools/sandbox/setup.h"

namespace sandrunner::sandbox {

/// A simulated robot with its controller and policy.
struct Robot {
  Robot(const Setup& setup, const ControllerConfig& controller, Mode start);

  std::uint64_t state_hash();

  PolicyRunner policy;
  sim::Simulator simulator;
  Lockstep loop;
};

/// The run that `sandrunner` makes with the same settings, under a constant command.
struct ScriptedRun {
  ScriptedRun(const Setup& setup, const VelocityCommand& command, const RunPlan& plan);

  /// Runs `ticks` ticks, or until the end of the run. True: it goes on.
  bool advance(int ticks);

  CommandSource command;
  RunScript script;
  Robot robot;
};

/// What pages of `sandrunner --view --command live` do, without a server.
class PageRun {
 public:
  explicit PageRun(const Setup& setup);

  /// Ticks; what is seen of them replaces what was seen before.
  void advance(int ticks);
  void drive(const VelocityCommand& command);
  /// A row of kRequestTable. Returns why not; null: it is done.
  const char* request(std::size_t row);
  void push(double direction_rad);
  void set_on_legs() { operator_.begin(); }
  void set_terrain(const sim::TerrainDescription& terrain);

  double now_s() const;
  Mode mode() const { return remote_.mode(); }
  const sim::TerrainDescription& terrain() const { return terrain_; }
  // Seen in the last ticks.
  std::vector<RunRow> rows;
  std::vector<Footprint> footprints;
  std::vector<ViewTile> tiles;

 private:
  void see();

  const char* const no_walk_;
  sim::TerrainDescription terrain_;
  Robot robot_;
  RemoteOperator remote_;
  ReturnToStand operator_{remote_};
  OperatorRequests asked_;
  RunScene scene_;
  RowMaker maker_{scene_};
  std::set<std::pair<std::int32_t, std::int32_t>> tiles_seen_;
};

}  // namespace sandrunner::sandbox
