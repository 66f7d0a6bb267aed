// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/lockstep.h"
#include "rt/run_record.h"
#include "sim/simulator.h"

namespace sandrunner {

/// The state of robot and loop as a sample of the run's record. `truth`: what `loop`'s estimate
/// should be.
RunSample make_sample(const sim::Simulator& simulator, const Lockstep& loop,
                      const StateEstimate& truth);

}  // namespace sandrunner
