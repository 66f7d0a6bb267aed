// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/study/experiments/lab.h"

namespace sandrunner::study {

struct Options {
  std::string from, out;
  std::vector<std::string> only;  ///< experiments, in their order
  std::vector<int> seeds;         ///< empty: all
  LabSettings lab;
  std::string published;  ///< the authors' network as a policy file; empty: none
  std::string contact;    ///< JSON of `sandrunner-bench contact`; empty: none
};

/// Nothing if the command line asked for help alone. Throws InputError.
std::optional<Options> parse_options(int argc, const char* const* argv);

}  // namespace sandrunner::study
