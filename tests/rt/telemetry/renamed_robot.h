// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

#include "policy/policy_file.h"
#include "sim/robot/embedded.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {

/// Writes the shipped robot into `folder`, with the names of example_robot() (example_tick.h), and
/// returns the path of its file, for the setting `robot`.
inline std::string write_renamed_robot(const TemporaryFolder& folder) {
  for (const std::string type : {".urdf", ".toml"}) {
    std::string text(embedded_robot_file("raibo" + type));
    for (const auto& [from, to] : {std::pair<std::string, std::string>{"\"raibo", "\"example"},
                                   {"\"base\"", "\"trunk\""},
                                   {"\"LF", "\"FL"},
                                   {"\"RF", "\"FR"},
                                   {"\"LH", "\"RL"},
                                   {"\"RH", "\"RR"},
                                   {"_HAA\"", "_hip\""},
                                   {"_HFE\"", "_thigh\""},
                                   {"_KFE\"", "_calf\""}}) {
      for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
        text.replace(at, from.size(), to);
      }
    }
    write_file(folder.path("example" + type), text);
  }
  return folder.path("example.toml");
}

/// Writes the shipped policy into `folder` for the robot of that name; returns its path.
inline std::string write_renamed_policy(const TemporaryFolder& folder) {
  const std::string path = folder.path("example.safetensors");
  write_file(path, std::string(shipped_policy_text()));
  PolicyFile file = read_policy_file(path);
  file.spec.joint_names = example_robot().joint_names;
  write_policy_file(path, file);
  return path;
}

}  // namespace sandrunner
