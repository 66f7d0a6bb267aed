// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/files.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

namespace sandrunner::evaluate {
namespace {

// A field of a CSV file (RFC 4180).
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string(2, c) : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::string results_json(const Results& results, const std::string& robot, const Options& options) {
  using Json = nlohmann::ordered_json;
  Json j;
  j["version"] = SANDRUNNER_VERSION;
  j["settings"] = {{"policy", options.policy_path},
                   {"against", options.against_path.empty() ? Json() : Json(options.against_path)},
                   {"robot", robot},
                   {"seed", options.study.seed},
                   {"runs", options.study.runs},
                   {"grid_runs", options.study.grid_runs},
                   {"torque_speed_line", options.torque_speed_line}};
  j["policies"] = Json::array();
  for (std::size_t p = 0; p < results.policies.size(); ++p) {
    Json policy;
    policy["name"] = results.policies[p];
    for (const PartResults& part : results.parts) {
      if (part.part.name == "commands") {
        const CommandEnvelope& e = results.envelopes[p];
        policy["envelope"] = {{"forward_mps", e.forward_mps},
                              {"backward_mps", e.backward_mps},
                              {"lateral_mps", e.lateral_mps},
                              {"yaw_radps", e.yaw_radps}};
      }
      Json groups = Json::array();
      for (std::size_t g = 0; g < part.part.groups.size(); ++g) {
        const Group& group = part.part.groups[g];
        Json out;
        out["ground"] = group.ground;
        if (part.part.name == "grid") {
          out["sigma_flat_npm3"] = group.sigma_flat_npm3;
          out["sigma_cone_npm3"] = group.sigma_cone_npm3;
        } else {
          if (!group.scenario.empty()) out["scenario"] = group.scenario;
          out["command"] = {{"vx_mps", group.command.vx_mps},
                            {"vy_mps", group.command.vy_mps},
                            {"wz_radps", group.command.wz_radps}};
        }
        out["runs"] = part.runs[p][g].size();
        for (const Metric& m : metrics()) {
          const Estimate e = pool(m, part.runs[p][g]);
          if (e.n == 0) {
            out[m.key] = Json();
          } else {
            out[m.key] = {{"value", e.value}, {"low", e.low}, {"high", e.high}, {"n", e.n}};
          }
        }
        groups.push_back(std::move(out));
      }
      policy[part.part.name] = std::move(groups);
    }
    j["policies"].push_back(std::move(policy));
  }
  // A path need not be UTF-8.
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string part_csv(const PartResults& results, const std::vector<std::string>& policies) {
  std::string text =
      "policy,ground,scenario,command_vx_mps,command_vy_mps,command_wz_radps,sigma_flat_npm3,"
      "sigma_cone_npm3,runs";
  for (const Metric& m : metrics()) text += fmt::format(",{0},{0}_low,{0}_high,{0}_n", m.key);
  text += "\n";
  for (std::size_t g = 0; g < results.part.groups.size(); ++g) {
    const Group& group = results.part.groups[g];
    for (std::size_t p = 0; p < policies.size(); ++p) {
      text += fmt::format("{},{},{},{},{},{},{},{},{}", quoted(policies[p]), group.ground,
                          group.scenario, group.command.vx_mps, group.command.vy_mps,
                          group.command.wz_radps, group.sigma_flat_npm3, group.sigma_cone_npm3,
                          results.runs[p][g].size());
      for (const Metric& m : metrics()) {
        const Estimate e = pool(m, results.runs[p][g]);
        for (const double v : {e.value, e.low, e.high}) {
          text += std::isnan(v) ? "," : fmt::format(",{:.6g}", v);
        }
        text += fmt::format(",{}", e.n);
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace sandrunner::evaluate
