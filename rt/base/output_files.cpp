// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/output_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw InputError(fmt::format("{}: cannot be written ({})", path, reason));
}

[[noreturn]] void fail_with_errno(const std::string& path) {
  fail(path, std::generic_category().message(errno));
}

/// Makes a new name survive a power cut. Not every file system offers it: no error.
void flush_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

void prepare_folder(const std::string& folder, const std::string& option) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::error_code none;
  if (std::filesystem::is_regular_file(folder, none)) {
    throw InputError(fmt::format("{}: '{}' is a file, expected a folder", option, folder));
  }
  if (error || !std::filesystem::is_directory(folder, none) ||
      access(folder.c_str(), W_OK | X_OK) != 0) {
    throw InputError(fmt::format("{}: folder '{}' cannot be written", option, folder));
  }
}

WholeFile::WholeFile(std::string path) : path_(std::move(path)), part_(path_ + ".part") {
  // Renaming over /dev/null would replace it, for everybody.
  std::error_code ignored;
  const auto status = std::filesystem::status(path_, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    fail(path_, "not a regular file");
  }
  // What is left of a program that was killed, or a link that is in its place: it is removed and
  // not followed.
  ::unlink(part_.c_str());
  descriptor_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail_with_errno(path_);
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!kept_) ::unlink(part_.c_str());
}

void WholeFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_with_errno(path_);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void WholeFile::keep() {
  if (::fsync(descriptor_) != 0) fail_with_errno(path_);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail_with_errno(path_);
  if (::rename(part_.c_str(), path_.c_str()) != 0) fail_with_errno(path_);
  kept_ = true;
  flush_folder_of(path_);
}

void write_file(const std::string& path, std::string_view bytes) {
  WholeFile file(path);
  file.write(bytes);
  file.keep();
}

}  // namespace sandrunner
