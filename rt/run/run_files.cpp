// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/run_files.h"

#include <fmt/format.h>

#include "rt/base/output_files.h"
#include "rt/report/run_csv.h"
#include "rt/telemetry/view/view_page.h"

namespace sandrunner {

std::string write_run_files(const RunRecord& record, const std::string& folder) {
  const std::string dir = folder + "/";
  write_csv(record, dir + "run.csv");
  write_file(dir + "run.html", run_page(record));
  return fmt::format("{0}run.csv, {0}run.html", dir);
}

}  // namespace sandrunner
