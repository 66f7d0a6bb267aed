// SPDX-License-Identifier: BSD-3-Clause
// The paper's controllers: what their files are. Names and looks are in ../page/controllers.py.
#pragma once

#include <string_view>
#include <vector>

namespace sandrunner::study {

struct Controller {
  const char* key;  ///< of its files and in results.json
  const char* wiring = "encoder lstm, actor sees encoding, estimate";  ///< wiring_text
  bool is_published =
      false;  ///< the authors' own (--published): in tables and figures, in no verdict
};

/// All of them, in the order of the tables.
const std::vector<Controller>& controllers();
/// The one with this key; null: there is none.
const Controller* find_controller(std::string_view key);

/// Those that the trainer makes: all but the authors' network.
const std::vector<const char*>& trained_controllers();

}  // namespace sandrunner::study
