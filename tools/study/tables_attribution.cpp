// SPDX-License-Identifier: BSD-3-Clause
// The tables of E8.
#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "tools/study/controllers.h"
#include "tools/study/html.h"
#include "tools/study/oracles.h"
#include "tools/study/tables.h"

namespace sandrunner::study {
namespace {

Figure of_list(const Evidence& evidence, const char* oracle, const char* list, std::size_t at,
               const char* over = nullptr) {
  return evidence.figure("E8", oracle, [&](const Measured& m) {
    const auto& lists = m.select(kOracleGround).at(0)->lists;
    const double value = lists.at(list).at(at);
    return SeedValue{over == nullptr ? value : value / lists.at(over).at(at)};
  });
}

// What the figures rest on, and whether integrated gradients add up.
std::string states_table(const Evidence& evidence) {
  HtmlTable table{{"controller", "seeds", "robots, 4 s each", "states", "robots that fell, %",
                   "integrated gradients miss the change: median, %", "99th percentile, %"},
                  {}};
  for (const char* oracle : oracle_controllers()) {
    const auto* seeds = evidence.find("E8", oracle);
    std::vector<std::string> row = {find_controller(oracle)->name};
    if (seeds == nullptr) {
      row.insert(row.end(), {"<span class=\"faint\">not run</span>", "", "", "", "", ""});
    } else {
      std::vector<int> numbers;
      for (const auto& [seed, measured] : *seeds) numbers.push_back(seed);
      row.push_back(fmt::format("{}", fmt::join(numbers, ", ")));
      row.push_back(printed(of_list(evidence, oracle, "robots", 0), 1.0, 0));
      row.push_back(printed(of_list(evidence, oracle, "states", 0), 1.0, 0));
      row.push_back(printed(of_list(evidence, oracle, "fell", 0), 100.0, 1));
      row.push_back(printed(of_list(evidence, oracle, "gap_median", 0), 100.0, 2));
      row.push_back(printed(of_list(evidence, oracle, "gap_p99", 0), 100.0, 2));
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
    const auto figure = [&](const char* group, const char* over = nullptr) {
      return evidence.figure("E8", oracle, [&](const Measured& m) {
        const auto& groups = m.select(kOracleGround);
        const double value = mean_value(groups, group).value;
        return SeedValue{over == nullptr ? value : value / mean_value(groups, over).value};
      });
    };
    const char* const second = oracle == std::string_view("oracle-h") ? "h" : "o";
    table.rows.push_back({find_controller(oracle)->name, printed(figure("cmd"), 1.0, 4),
                          printed(figure(second), 1.0, 4), printed(figure("e"), 1.0, 4),
                          printed(figure("T"), 1.0, 4), printed(figure("e", "T"), 1.0, 2)});
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
        row.emplace_back("<span class=\"faint\">not run</span>");
      } else {
        row.push_back(
            printed(of_list(evidence, column.oracle, column.list, i, column.over), 1.0, 4));
      }
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
