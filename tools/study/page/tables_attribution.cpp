// SPDX-License-Identifier: BSD-3-Clause
// The tables of E8.
#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/oracles.h"
#include "tools/study/page/html.h"
#include "tools/study/page/tables.h"

namespace sandrunner::study {
namespace {

// What the figures rest on, and whether integrated gradients add up.
std::string states_table(const Evidence& evidence) {
  HtmlTable table{{"controller", "seeds", "robots, 4 s each", "states", "robots that fell, %",
                   "integrated gradients miss the change: median, %", "99th percentile, %"},
                  {}};
  for (const char* oracle : oracle_controllers()) {
    const auto* seeds = evidence.find("E8", oracle);
    std::vector<std::string> row = {find_controller(oracle)->name};
    if (seeds == nullptr) {
      row.insert(row.end(), {kNotRun, "", "", "", "", ""});
    } else {
      row.push_back(range_of_seeds(*seeds));
      row.push_back(printed(oracle_value(evidence, oracle, "robots", 0), 1.0, 0));
      row.push_back(printed(oracle_value(evidence, oracle, "states", 0), 1.0, 0));
      row.push_back(printed(oracle_value(evidence, oracle, "fell", 0), 100.0, 1));
      row.push_back(printed(oracle_value(evidence, oracle, "gap_median", 0), 100.0, 2));
      row.push_back(printed(oracle_value(evidence, oracle, "gap_p99", 0), 100.0, 2));
    }
    table.rows.push_back(row);
  }
  return table.html();
}

// The numbers of Fig. 4 E.
std::string group_table(const Evidence& evidence) {
  HtmlTable table{{"mean |change of an action| without", "cmd", "h or o", "e", "T", "e over T"},
                  {}};
  for (const char* oracle : oracle_controllers()) {
    if (evidence.find("E8", oracle) == nullptr) continue;
    const auto figure = [&](const char* group) { return oracle_ablation(evidence, oracle, group); };
    const char* const second = oracle == std::string_view("oracle-h") ? "h" : "o";
    table.rows.push_back({find_controller(oracle)->name, printed(figure("cmd"), 1.0, 4),
                          printed(figure(second), 1.0, 4), printed(figure("e"), 1.0, 4),
                          printed(figure("T"), 1.0, 4),
                          printed(ratio(figure("e"), figure("T")), 1.0, 2)});
  }
  return table.html();
}

std::string parameter_table(const Evidence& evidence) {
  HtmlTable table{{"parameter", "as the actor sees it"}, {}};
  struct Column {
    const char *oracle, *title, *list, *over;
  };
  const Column kColumns[] = {
      {"oracle-o", "deviation over the states", "deviation", nullptr},
      {"oracle-o", "Oracle(O), mean |IG|: HAA", "gradient_haa", nullptr},
      {"oracle-o", "HFE", "gradient_hfe", nullptr},
      {"oracle-o", "KFE", "gradient_kfe", nullptr},
      {"oracle-o", "of KFE, over the deviation", "gradient_kfe", "deviation"},
      {"oracle-o", "alone: Oracle(O)", "alone", nullptr},
      {"oracle-h", "Oracle(H)", "alone", nullptr}};
  for (const Column& column : kColumns) table.heads.emplace_back(column.title);
  for (std::size_t i = 0; i < std::size(kTerrainParameters); ++i) {
    const TerrainParameter& parameter = kTerrainParameters[i];
    std::vector<std::string> row = {parameter.name, parameter.seen_as};
    for (const Column& column : kColumns) {
      if (evidence.find("E8", column.oracle) == nullptr) {
        row.emplace_back(kNotRun);
        continue;
      }
      const Figure figure = oracle_value(evidence, column.oracle, column.list, i);
      row.push_back(
          printed(column.over == nullptr
                      ? figure
                      : ratio(figure, oracle_value(evidence, column.oracle, column.over, i)),
                  1.0, 4));
    }
    table.rows.push_back(row);
  }
  return table.html();
}

}  // namespace

std::string attribution_tables(const Evidence& evidence) {
  return states_table(evidence) + group_table(evidence) + parameter_table(evidence) +
         "<p class=\"note\">|IG|: magnitude of the integrated gradient; alone: ablation of this "
         "parameter alone. Both are of an action.</p>\n";
}

}  // namespace sandrunner::study
