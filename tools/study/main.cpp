// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-study: the paper's experiments on trained controllers, and the page they end in.
#include <fmt/format.h>

#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "tools/study/experiments/measurements.h"
#include "tools/study/experiments/models.h"
#include "tools/study/experiments/options.h"
#include "tools/study/page/report.h"

namespace sandrunner::study {
namespace {

int run(int argc, char** argv) {
  const std::optional<Options> options = parse_options(argc, argv);
  if (!options) return kExitOk;
  const sim::Robot robot = sim::load_raibo();
  std::vector<Model> models = load_models(options->from, options->seeds, robot);
  if (!options->published.empty()) models.push_back(load_published(options->published, robot));
  prepare_folder(options->out, "--out");
  const Evidence evidence = measure(*options, models);
  write_report(*options, models, evidence);
  fmt::print("wrote {}/report.html\n", options->out);
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner::study

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-study",
                                 [&] { return sandrunner::study::run(argc, argv); });
}
