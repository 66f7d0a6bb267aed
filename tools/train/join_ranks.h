// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "tools/train/data/ranks.h"

namespace sandrunner::train {

/// The processes that mpirun started together with this one; null: it is alone. Each program has
/// its own: alone.cpp that of sandrunner-train, mpi.cpp that of sandrunner-train-mpi. Once in a
/// process.
std::unique_ptr<learner::Exchange> join_ranks();

}  // namespace sandrunner::train
