// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner {

/// All keys of a run's settings and of a robot's file with default, unit, range and meaning, as
/// Markdown: what `sandrunner --settings` prints, and a part of rt/README.md.
std::string settings_reference();

}  // namespace sandrunner
