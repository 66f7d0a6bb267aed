// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/evidence/controllers.h"

#include <algorithm>

namespace sandrunner::study {

const std::vector<Controller>& controllers() {
  constexpr const char* kTeacher = "encoder insight, actor sees encoding, proprioception";
  constexpr const char* kStudent = "encoder lstm, actor sees encoding, proprioception";
  static const std::vector<Controller> kAll = {
      {"ours", "Ours", {{0.05, 0.32, 0.70}}, ModelKind::kPolicy},
      {"env-rigid", "Env-Rigid", {{0.84, 0.37, 0.00}, {9.0, 4.0}}, ModelKind::kPolicy},
      {"env-quasistatic", "Env-Quasistatic", {{0.00, 0.55, 0.40}, {3.0, 3.0}}, ModelKind::kPolicy},
      {"env-linear", "Env-Linear", {{0.58, 0.25, 0.65}, {9.0, 3.0, 2.0, 3.0}}, ModelKind::kPolicy},
      {"pl-gm", "PL/Env-GM", {{0.80, 0.10, 0.20}, {14.0, 4.0}}, ModelKind::kStudyModel, kStudent},
      {"pl-rigid",
       "PL/Env-Rigid",
       {{0.45, 0.29, 0.15}, {5.0, 5.0}},
       ModelKind::kStudyModel,
       kStudent},
      {"teacher-gm", "Teacher/Env-GM", {{0.35, 0.35, 0.38}}, ModelKind::kSeesGround, kTeacher},
      {"teacher-rigid",
       "Teacher/Env-Rigid",
       {{0.60, 0.60, 0.62}, {9.0, 4.0}},
       ModelKind::kSeesGround,
       kTeacher},
      {"oracle-h",
       "Oracle(H)",
       {{0.00, 0.60, 0.75}, {12.0, 3.0, 2.0, 3.0}},
       ModelKind::kSeesGround,
       "encoder lstm, actor sees encoding, estimate, terrain"},
      {"oracle-o",
       "Oracle(O)",
       {{0.85, 0.60, 0.05}, {3.0, 3.0}},
       ModelKind::kSeesGround,
       "encoder lstm, actor sees estimate, proprioception, terrain"},
      {"tcn",
       "TCN",
       {{0.75, 0.25, 0.50}, {2.0, 4.0}},
       ModelKind::kStudyModel,
       "encoder tcn, actor sees encoding, estimate"},
      {"published", "Authors' network", {{0.10, 0.10, 0.10}, {2.0, 3.0}}, ModelKind::kPublished},
  };
  return kAll;
}

const Controller* find_controller(std::string_view key) {
  const auto& all = controllers();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Controller& c) { return key == c.key; });
  return found == all.end() ? nullptr : &*found;
}

const std::vector<const char*>& trained_controllers() {
  static const std::vector<const char*> kKeys = [] {
    std::vector<const char*> keys;
    for (const Controller& c : controllers()) {
      if (c.kind != ModelKind::kPublished) keys.push_back(c.key);
    }
    return keys;
  }();
  return kKeys;
}

const std::vector<const char*>& beach_controllers() {
  static const std::vector<const char*> kKeys = {"ours",       "env-rigid", "env-quasistatic",
                                                 "env-linear", "pl-gm",     "pl-rigid"};
  return kKeys;
}

const std::vector<const char*>& mattress_controllers() {
  static const std::vector<const char*> kKeys = {"ours", "env-rigid", "pl-gm", "pl-rigid"};
  return kKeys;
}

}  // namespace sandrunner::study
