// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/controllers.h"

#include <algorithm>

namespace sandrunner::study {

const std::vector<Controller>& controllers() {
  constexpr const char* kTeacher = "encoder insight, actor sees encoding, proprioception";
  constexpr const char* kStudent = "encoder lstm, actor sees encoding, proprioception";
  static const std::vector<Controller> kAll = {
      {"ours"},
      {"env-rigid"},
      {"env-quasistatic"},
      {"env-linear"},
      {"pl-gm", kStudent},
      {"pl-rigid", kStudent},
      {"teacher-gm", kTeacher},
      {"teacher-rigid", kTeacher},
      {"oracle-h", "encoder lstm, actor sees encoding, estimate, terrain"},
      {"oracle-o", "encoder lstm, actor sees estimate, proprioception, terrain"},
      {"tcn", "encoder tcn, actor sees encoding, estimate"},
      {.key = "published", .is_published = true},
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
      if (!c.is_published) keys.push_back(c.key);
    }
    return keys;
  }();
  return kKeys;
}

}  // namespace sandrunner::study
