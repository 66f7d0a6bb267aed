// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/build.h"

namespace sandrunner {

std::string build_commit() { return SANDRUNNER_COMMIT; }

std::string build_name() {
#ifdef __clang__
  const std::string compiler = "clang";
#else
  const std::string compiler = "g++";
#endif
  return SANDRUNNER_VERSION " " SANDRUNNER_COMMIT " " + compiler + " " __VERSION__;
}

}  // namespace sandrunner
