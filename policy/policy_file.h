// SPDX-License-Identifier: BSD-3-Clause
// Policy files: safetensors whose metadata says everything that is needed to run the policy, with a
// golden example. README.md of this folder defines the format.
#pragma once

#include <string>
#include <string_view>

#include "policy/golden.h"
#include "policy/policy.h"

namespace sandrunner {

/// Content of a policy file.
struct PolicyFile {
  PolicySpec spec;
  NetworkParameters parameters;
  GoldenExample golden;
};

/// Reads a file, checks all of it and runs its golden example. Throws InputError, in one line that
/// names the file and the tensor or key, if anything is missing, unknown, of the wrong size or out
/// of range.
PolicyFile read_policy_file(const std::string& path);
/// The same from the bytes of a file; `name` stands for it in errors.
PolicyFile parse_policy_file(std::string_view content, const std::string& name);

/// The policy of a file, ready to run. Errors as read_policy_file, and for a network that needs
/// what a robot cannot sense.
Policy load_policy(const std::string& path);
/// The policy in the bytes of a file; `name` stands for it in errors.
Policy load_policy_text(std::string_view content, const std::string& name);

/// The policy that ships for a robot of this name (policy/trained), built into the program. Text:
/// empty if none does.
Policy load_shipped_policy(const std::string& robot = "raibo");
std::string_view shipped_policy_text(const std::string& robot = "raibo");

/// Checks `file` as read_policy_file would, then writes it; `path` is whole or untouched. Throws
/// InputError.
void write_policy_file(const std::string& path, const PolicyFile& file);

/// Changes what a file says of a policy: "KEY=VALUE", a key of the metadata without "sandrunner.".
/// Throws InputError.
void set_in_spec(PolicyFile& file, const std::string& assignment);

/// Reads the layout in which others publish such networks: the same tensors without a golden
/// example; whatever metadata they have becomes the provenance. The rest of the result is left at
/// its defaults. Throws InputError.
PolicyFile read_bare_weights(const std::string& path);

}  // namespace sandrunner
