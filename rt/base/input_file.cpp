// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/input_file.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& reason,
                       const std::string& expected) {
  throw InputError(fmt::format("{}: cannot be read ({}), expected {}", path, reason, expected));
}

}  // namespace

void require_regular_file(const std::string& path, const std::string& expected) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(path, error.message(), expected);
  if (!std::filesystem::is_regular_file(status)) fail(path, "not a regular file", expected);
}

std::string read_input_file(const std::string& path, const std::string& expected,
                            std::size_t most_bytes) {
  require_regular_file(path, expected);
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, std::generic_category().message(errno), expected);
  // What the system says of a size need not be true (/proc), so it is read to its end.
  std::string content;
  std::array<char, 65536> block{};
  while (file.read(block.data(), block.size()) || file.gcount() > 0) {
    content.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (content.size() > most_bytes) {
      fail(path, fmt::format("more than {} bytes", most_bytes), expected);
    }
  }
  if (file.bad()) fail(path, std::generic_category().message(errno), expected);
  return content;
}

}  // namespace sandrunner
