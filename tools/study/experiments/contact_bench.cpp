// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/contact_bench.h"

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

#include "rt/base/errors.h"
#include "rt/base/input_file.h"

namespace sandrunner::study {
namespace {

// "final depth 14.4 (quartiles 11.8 and 17.8), their range over it 0.42; ..."
double spread_in(const std::string& text, const std::string& path) {
  constexpr std::string_view kBefore = "their range over it ";
  const std::size_t at = text.find(kBefore);
  double spread = 0.0;
  if (at == std::string::npos ||
      std::sscanf(text.c_str() + at + kBefore.size(), "%lf", &spread) != 1) {
    throw InputError(
        fmt::format("--contact {}: found '{}', expected '{}' and a number", path, text, kBefore));
  }
  return spread;
}

}  // namespace

Json read_contact_bench(const std::string& path) {
  const Json json = Json::parse(read_input_file(path, "a file of sandrunner-bench contact --json"),
                                nullptr, false);
  Json bench;
  try {
    bench["ratio"] = json.at("drft_vs_cone").at("median").get<double>();
    for (const char* text : {"processor", "cone_mm", "drft_mm", "planar_mm"}) {
      bench[text] = json.at(text).get<std::string>();
    }
  } catch (const Json::exception&) {
    throw InputError(fmt::format(
        "--contact {}: found something else, expected what `sandrunner-bench contact --json FILE` "
        "writes",
        path));
  }
  for (const char* model : {"cone", "drft", "planar"}) {
    bench[fmt::format("spread_{}", model)] =
        spread_in(bench[fmt::format("{}_mm", model)].get<std::string>(), path);
  }
  return bench;
}

}  // namespace sandrunner::study
