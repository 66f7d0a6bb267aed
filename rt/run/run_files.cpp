// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/run_files.h"

#include <fmt/format.h>

#include "rt/base/output_files.h"
#include "rt/report/run_csv.h"
#include "rt/report/run_pictures.h"
#include "rt/telemetry/view/view_page.h"

namespace sandrunner {

std::string write_run_files(const RunRecord& record, const std::string& folder) {
  const std::string dir = folder + "/";
  write_csv(record, dir + "run.csv");
  draw_run_plot(record, dir + "run.png");
  write_file(dir + "run.html", run_page(record));
  std::string paths = fmt::format("{0}run.csv, {0}run.html, {0}run.png", dir);
  if (!record.has_truth()) return paths;
  draw_run_strip(record, dir + "strip.png");
  return fmt::format("{}, {}strip.png", paths, dir);
}

}  // namespace sandrunner
