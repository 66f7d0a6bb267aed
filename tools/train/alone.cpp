// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/join_ranks.h"

namespace sandrunner::train {

std::unique_ptr<learner::Exchange> join_ranks() { return nullptr; }

}  // namespace sandrunner::train
