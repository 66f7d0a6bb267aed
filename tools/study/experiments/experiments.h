// SPDX-License-Identifier: BSD-3-Clause
// The experiments that are run on controllers. Each takes one model and yields numbers; what they
// mean is for ../page to say.
#pragma once

#include <vector>

#include "tools/study/experiments/lab.h"

namespace sandrunner::study {

struct Experiment {
  const char* key;  ///< in results.json and of --only
  std::vector<const char*> controllers;
  Measured (*run)(Lab& lab, const Model& model);
};

/// All of them, in the order of the page. The first, "fairness", is always run.
const std::vector<Experiment>& experiments();

/// Fairness: 1, 2 and 3 m/s on the ground on which the controller was trained.
Measured run_fairness(Lab& lab, const Model& model);
/// E1, Table 1 and Fig. 2 C to F: eight commands on beaches that differ from run to run.
Measured run_beach(Lab& lab, const Model& model);
/// E2, Fig. 2 A, B and movie S1: a loose stance, and from dry onto wet sand.
Measured run_recovery(Lab& lab, const Model& model);
/// E3, Fig. 3 D, E: vinyl, track and grass; and turns on five grounds.
Measured run_grounds(Lab& lab, const Model& model);
/// E4, Fig. 3 F: the hidden state on four grounds.
Measured run_hidden_state(Lab& lab, const Model& model);
/// E5, Fig. 3 G, H: turns on the air mattress.
Measured run_mattress(Lab& lab, const Model& model);
/// E6, S8: from hard ground onto memory foam.
Measured run_foam(Lab& lab, const Model& model);
/// E7, Fig. 4 A to D: rewards and clearances over a grid of stiffnesses, in the training's
/// environments.
Measured run_grid(Lab& lab, const Model& model);
/// E8, Fig. 4 E to G and S11: what the answers of an oracle depend on (oracles.h).
Measured run_attribution(Lab& lab, const Model& model);

/// The ground of a run on the beach: run 0 has the preset, the others have stiffnesses that differ
/// by up to 35 %, a friction of 0.6 to 0.9 and 0.8 to 1.2 times the inertia.
sim::TerrainDescription beach(int run);
/// The level ground that stands for a controller's training.
sim::TerrainDescription training_ground(const Controller& controller, const sim::Robot& robot);

}  // namespace sandrunner::study
