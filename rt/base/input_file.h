// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace sandrunner {

/// No file that a program reads whole has reason to be larger: a policy has half a megabyte, a
/// checkpoint of the trainer ten.
inline constexpr std::size_t kLargestInputFile_bytes = std::size_t{64} << 20;

/// Throws InputError unless there is a regular file at `path`: a folder, a device or a pipe could
/// be endless or never answer. `expected` says in the message what it should be ("a TOML file").
void require_regular_file(const std::string& path, const std::string& expected);

/// The bytes of a regular file of at most `most_bytes`; throws InputError otherwise.
std::string read_input_file(const std::string& path, const std::string& expected,
                            std::size_t most_bytes = kLargestInputFile_bytes);

}  // namespace sandrunner
