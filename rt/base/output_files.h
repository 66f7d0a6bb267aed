// SPDX-License-Identifier: BSD-3-Clause
// Files that a program leaves behind: whole, or not at all.
#pragma once

#include <string>
#include <string_view>

namespace sandrunner {

/// Makes the folder if need be. Throws InputError, which names `option`, if nothing can be written
/// there: now rather than after the run.
void prepare_folder(const std::string& folder, const std::string& option);

/// A file that gets its name when it is whole. Its contents are written next to it, in
/// `path`.part, and flushed to the disk before the file is renamed. If it is not kept, the part is
/// removed, and a file that had the name before is as it was. Links of either name are replaced,
/// not followed. Throws InputError with the path and the system's reason if the file cannot be
/// made, written or renamed.
class WholeFile {
 public:
  /// Makes the part: a place that cannot be written is found here, before the work.
  explicit WholeFile(std::string path);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(std::string_view bytes);
  /// For a writer of its own, which is to be done before `keep`.
  const std::string& part_path() const { return part_; }
  /// Once, at the end.
  void keep();

 private:
  std::string path_, part_;
  int descriptor_;
  bool kept_ = false;
};

/// A WholeFile of these bytes.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace sandrunner
