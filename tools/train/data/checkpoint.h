// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tools/train/data/ranks.h"

namespace sandrunner::learner {

/// FNV-1a hash of the bytes, continued from `hash`.
inline constexpr std::uint64_t kHashStart = 0xcbf29ce484222325ULL;
std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash = kHashStart);

/// State of a training as named sections of bytes: the learner's, and whatever the program adds
/// (environments, curriculum, progress) to continue to the same bits.
struct Checkpoint {
  std::string architecture;  ///< sizes that the state belongs to, readable
  std::uint64_t config_hash = 0;
  std::map<std::string, std::vector<char>> sections;
  std::string source;                ///< file it was read from, for messages
  std::vector<std::string> of_envs;  ///< sections put by put_envs

  template <typename T>
  void put(const std::string& name, const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<char>& bytes = sections[name];
    bytes.resize(count * sizeof(T));
    if (count > 0) std::memcpy(bytes.data(), values, bytes.size());
  }

  /// Likewise, of as many values for each environment.
  template <typename T>
  void put_envs(const std::string& name, const T* values, std::size_t count) {
    put(name, values, count);
    of_envs.push_back(name);
  }
  /// Gets what the other ranks have put of the environments of their blocks.
  void gather(const Ranks& ranks, int blocks) {
    for (const std::string& name : of_envs) ranks.gather(std::span(sections[name]), blocks);
  }

  /// Throws InputError if the section is missing or is not `count` values long.
  template <typename T>
  void get(const std::string& name, T* values, std::size_t count) const {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::vector<char>& bytes = section(name, count * sizeof(T));
    if (count > 0) std::memcpy(values, bytes.data(), bytes.size());
  }

 private:
  const std::vector<char>& section(const std::string& name, std::size_t expected_bytes) const;
};

/// Writes the file whole (rt/base/output_files.h): `path` is always a checkpoint, the old or the
/// new one. Throws InputError (disk full, no such folder, ...) and then leaves `path` as it was.
void save_checkpoint(const Checkpoint& checkpoint, const std::string& path);

/// Throws InputError if the file cannot be read, is no checkpoint, is truncated, or fails its
/// checksum.
Checkpoint load_checkpoint(const std::string& path);

}  // namespace sandrunner::learner
