// SPDX-License-Identifier: BSD-3-Clause
// The format in which networks of a study were stored before policy files named their wiring.
#pragma once

#include <string>

#include "policy/safetensors.h"

namespace sandrunner {

/// Turns the content of a file of the format "study 1" into that of a policy file, with the same
/// numbers: its wiring is in the settings of its training, and an LSTM is one matrix [weight_ih |
/// bias | weight_hh]. Leaves other content as it is. Throws InputError.
void renew_study_file(const std::string& path, TensorFile& content);

}  // namespace sandrunner
