// SPDX-License-Identifier: BSD-3-Clause
// Between mcap_reader.cpp, which finds the records of a file, and mcap_records.cpp, which takes
// them.
#pragma once

#include <fmt/format.h>

#include <cstring>
#include <string>
#include <utility>

#include "rt/telemetry/mcap/mcap_reader.h"

namespace sandrunner {

/// Takes the fields of one record one after the other, each checked against what is left of it.
class McapReader::Fields {
 public:
  Fields(McapReader& reader, std::span<const std::byte> body) : reader_(reader), left_(body) {}

  template <typename Number>
  Number number() {
    Number value;
    std::memcpy(&value, bytes(sizeof value).data(), sizeof value);
    return value;
  }

  std::span<const std::byte> bytes(std::uint64_t size) {
    if (size > left_.size()) {
      reader_.fail(
          fmt::format("found {} bytes left in it, expected a field of {}", left_.size(), size));
    }
    const auto taken = left_.first(static_cast<std::size_t>(size));
    left_ = left_.subspan(taken.size());
    return taken;
  }

  std::string string(std::uint64_t size) {
    const auto taken = bytes(size);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }
  std::string string() { return string(number<std::uint32_t>()); }

  McapMap map() {
    McapMap result;
    Fields entries(reader_, bytes(number<std::uint32_t>()));
    while (!entries.left_.empty()) {
      reader_.keep(128);  // roughly what a node costs besides its strings
      std::string key = entries.string();
      if (!result.emplace(std::move(key), entries.string()).second) {
        reader_.fail("found a key twice in a map, expected each once");
      }
    }
    return result;
  }

  std::span<const std::byte> rest() { return bytes(left_.size()); }
  std::size_t left() const { return left_.size(); }

 private:
  McapReader& reader_;
  std::span<const std::byte> left_;
};

}  // namespace sandrunner
