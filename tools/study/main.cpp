// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-study: the paper's experiments on trained controllers, and the page they end in.
#include <fmt/format.h>
#include <unistd.h>

#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "tools/study/experiments/contact_bench.h"
#include "tools/study/experiments/measurements.h"
#include "tools/study/experiments/models.h"
#include "tools/study/experiments/options.h"
#include "tools/study/experiments/results.h"

namespace sandrunner::study {
namespace {

constexpr const char* kPython = "/usr/bin/python3";

// Becomes the program that makes the page; comes back if standard output cannot be written.
void become_page_maker(const std::string& out) {
  if (std::fflush(stdout) != 0) return;
  // Isolated from what the user's Python has, and without files next to the source.
  execl(kPython, kPython, "-IB", SANDRUNNER_STUDY_PAGE, out.c_str(), nullptr);
  throw InputError(
      fmt::format("found no {0}, expected the Debian package python3; {1}/results.json is "
                  "complete: install it, then run {0} {2} {1}",
                  kPython, out, SANDRUNNER_STUDY_PAGE));
}

int run(int argc, char** argv) {
  const std::optional<Options> options = parse_options(argc, argv);
  if (!options) return kExitOk;
  const sim::Robot robot = sim::load_raibo();
  std::vector<Model> models = load_models(options->from, options->seeds, robot);
  if (!options->published.empty()) models.push_back(load_published(options->published, robot));
  const Json contact = options->contact.empty() ? Json() : read_contact_bench(options->contact);
  prepare_folder(options->out, "--out");
  const Measurements measurements = measure(*options, models);
  write_results(*options, models, measurements, contact);
  become_page_maker(options->out);
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner::study

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-study",
                                 [&] { return sandrunner::study::run(argc, argv); });
}
