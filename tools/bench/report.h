// SPDX-License-Identifier: BSD-3-Clause
// What a benchmark found, as a table and as JSON.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/bench/quartiles.h"

namespace sandrunner::bench {

struct Report {
  std::vector<std::pair<std::string, std::string>> facts;  ///< what was measured, on what
  std::vector<std::pair<std::string, Quartiles>> rates;    ///< steps/s, or as the name says
  std::vector<std::pair<std::string, Quartiles>> ratios;   ///< of rates of the same round
};

void print(const Report& report);

/// Model name of the processor, "unknown" where the system does not tell.
std::string processor_name();

/// A file that takes a report: opened at once, so that a place that cannot be written is found
/// before the measurement, and under its own name only when complete.
class ReportFile {
 public:
  /// Throws InputError.
  explicit ReportFile(std::string path);
  ~ReportFile();
  ReportFile(const ReportFile&) = delete;
  ReportFile& operator=(const ReportFile&) = delete;
  /// Throws InputError.
  void write(const Report& report);

 private:
  std::string path_, part_;
};

}  // namespace sandrunner::bench
