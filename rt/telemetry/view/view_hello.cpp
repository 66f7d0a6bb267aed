// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_hello.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "estimator/kinematics.h"
#include "rt/base/build.h"
#include "rt/core/faults.h"
#include "rt/core/mode_machine.h"
#include "rt/core/warnings.h"
#include "rt/operator/mode_requests.h"
#include "rt/report/run_row.h"
#include "rt/telemetry/view/view_tiles.h"

namespace sandrunner {
namespace {

constexpr int kNumModes = static_cast<int>(Mode::kFault) + 1;

std::array<std::string, kNumLegs> feet_links(const RobotDescription& robot) {
  std::array<std::string, kNumLegs> links;
  const auto feet = feet_of(robot);
  for (int l = 0; l < kNumLegs; ++l) {
    if (feet[l]) links[l] = feet[l]->frame;
  }
  return links;
}

nlohmann::ordered_json layout(std::span<const RowField> fields) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const RowField& f : fields) {
    json.push_back({{"name", f.name}, {"type", f.type}, {"offset", f.offset}, {"count", f.count}});
  }
  return json;
}

}  // namespace

std::span<const RowField> page_fields() {
  static const std::vector<RowField> fields = [] {
    std::vector<RowField> on_page;
    std::ranges::copy_if(kRowFields, std::back_inserter(on_page), &RowField::on_page);
    return on_page;
  }();
  return fields;
}

std::string view_hello(const RunScene& scene, const std::string& note) {
  const RobotDescription& robot = scene.robot;
  nlohmann::ordered_json json = {
      {"robot", robot.name},
      {"terrain", scene.terrain},
      {"policy", scene.policy},
      {"build", build_name()},
      {"note", note},
      {"granular", scene.granular_ground},
      {"slope", scene.slope},
      {"foot_radius_m", scene.foot_radius_m},
      {"legs", robot.leg_names},
      {"joints", robot.joint_names},
      {"feet", feet_links(robot)},
      {"base", robot.base_frame},
      {"frame_fields", layout(page_fields())},
      {"footprint_fields", layout(kFootprintFields)},
      {"tile_fields", layout(kViewTileFields)},
      {"tile_side", kViewTileSide},
      {"tile_step_m", kViewTileStep_m},
      {"modes", nlohmann::ordered_json::array()},
      {"faults", nlohmann::ordered_json::array()},
      {"warnings", nlohmann::ordered_json::array()},
      {"requests", nlohmann::ordered_json::array()},
      {"row_flags", {{"has_truth", kRowHasTruth}, {"has_estimate", kRowHasEstimate}}},
      {"row_kinds", kViewRowKinds},
      {"no_truth", kNoTruthNote},
      {"urdf", robot.ros_urdf}};
  for (int mode = 0; mode < kNumModes; ++mode) {
    json["modes"].push_back(mode_name(static_cast<Mode>(mode)));
  }
  for (const FaultRow& row : kFaultTable) {
    json["faults"].push_back({{"name", row.name}, {"meaning", row.meaning}});
  }
  for (const WarningRow& row : kWarningTable) json["warnings"].push_back(row.name);
  for (const RequestRow& row : kRequestTable) {
    nlohmann::ordered_json refused = nlohmann::ordered_json::array();  // why, by mode
    for (int mode = 0; mode < kNumModes; ++mode) {
      const char* const why = decide(row.name, static_cast<Mode>(mode), nullptr).refusal;
      refused.push_back(why ? why : "");
    }
    json["requests"].push_back({{"name", row.name},
                                {"key", row.key == 0 ? std::string() : std::string(1, row.key)},
                                {"refused", refused}});
  }
  return without_tags(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string without_tags(std::string json) {
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) {
    json.replace(at, 1, "\\u003c");
  }
  return json;
}

}  // namespace sandrunner
