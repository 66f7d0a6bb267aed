// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/output_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "rt/base/errors.h"

namespace sandrunner {

void prepare_folder(const std::string& folder, const std::string& option) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder) || access(folder.c_str(), W_OK | X_OK) != 0) {
    throw InputError(fmt::format("{}: folder '{}' cannot be written", option, folder));
  }
}

void write_text(const std::string& text, const std::string& path) {
  const std::string temporary = path + ".part";
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(temporary, path, error);
  if (!out || error) {
    std::filesystem::remove(temporary, error);
    throw InputError(fmt::format("{}: cannot be written, expected a folder with room", path));
  }
}

}  // namespace sandrunner
