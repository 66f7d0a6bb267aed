// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace sandrunner {

/// The one of `known` that `unknown` was probably meant to be: spelt nearly the same, the beginning
/// of it, or the same last part of a dotted path. Empty if there is none.
std::string likely_meant(const std::string& unknown, const std::vector<std::string>& known);

/// The end of an error message about `unknown`: ", did you mean 'known'?" or nothing.
std::string did_you_mean(const std::string& unknown, const std::vector<std::string>& known);

}  // namespace sandrunner
