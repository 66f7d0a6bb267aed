// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/processor_name.h"

#include <fstream>

namespace sandrunner {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  // A board with ARM tells what it is.
  std::ifstream model("/proc/device-tree/model");
  std::string name;
  std::getline(model, name, '\0');
  return name.empty() ? "unknown" : name;
}

}  // namespace sandrunner
