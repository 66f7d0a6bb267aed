// SPDX-License-Identifier: BSD-3-Clause
// What an experiment measured of one controller with one seed, as numbers with names: in memory and
// in results.json.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sandrunner::study {

using Json = nlohmann::ordered_json;

/// Runs that differ only in start, random numbers and, on the beach, in the sand.
struct RunGroup {
  std::string ground;
  std::string scenario;  ///< what else is particular; may be empty
  double command = 0.0;  ///< m/s or rad/s
  /// A figure's value in each run; nan where it is not defined.
  std::map<std::string, std::vector<double>> runs;
  /// Other lists: a run over time, points of a picture.
  std::map<std::string, std::vector<double>> lists;
  /// Float32 numbers, little-endian, in base64: what would be long as text.
  std::map<std::string, std::string> packed = {};
};

struct Measured {
  std::vector<RunGroup> groups;
};
/// [experiment][controller][seed].
using Measurements = std::map<std::string, std::map<std::string, std::map<int, Measured>>>;

Json to_json(const Measured& measured);
/// The reverse of to_json. Throws nlohmann::json::exception if `json` is something else.
Measured measured_from(const Json& json);

/// Mean of the values that are not nan; nan if there is none.
double mean_of(const std::vector<double>& values);

}  // namespace sandrunner::study
