// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace sandrunner {

/// What becomes of bare weights.
struct PolicyImport {
  std::string input;   ///< safetensors of the names of policy/README.md
  std::string output;  ///< policy file to write
  std::string name;    ///< of the policy; empty: that of `input`
  std::string robot = "raibo";
  /// Description of a network of others (description.h); empty: the network is ours.
  std::string observation;
  std::vector<std::string> assignments;  ///< KEY=VALUE
};

/// Writes the policy file, whole or not at all. Throws InputError.
void import_policy(const PolicyImport& given);

}  // namespace sandrunner
