// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace sandrunner {

/// Numbers of one row, by the names in the table's first line.
using CsvRow = std::map<std::string, double>;

/// Reads a table of numbers.
inline std::vector<CsvRow> read_csv(const std::string& path) {
  std::ifstream stream(path);
  std::string line, cell;
  std::getline(stream, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
  std::vector<CsvRow> rows;
  while (std::getline(stream, line)) {
    CsvRow& row = rows.emplace_back();
    std::istringstream cells(line);
    for (const std::string& name : names) {
      std::getline(cells, cell, ',');
      row[name] = std::stod(cell);
    }
  }
  if (rows.empty()) ADD_FAILURE() << "no table of numbers at " << path;
  return rows;
}

}  // namespace sandrunner
