// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "rt/report/row_maker.h"
#include "rt/report/run_record.h"
#include "tools/python/environments.h"

namespace sandrunner::python {

/// Follows one robot of the environments through an episode, and writes it as the page that
/// `sandrunner --out` calls run.html.
class Recorder {
 public:
  /// `environments` must outlive this object. Throws InputError for an index that there is not.
  Recorder(Environments& environments, int env);

  /// After every step: adds a row. False once the episode has ended; from there on nothing is
  /// added.
  bool add();
  /// Throws InputError if nothing was added, or if the file cannot be written.
  void write(const std::string& path, const std::string& title);

 private:
  TickRecord tick_now() const;
  void add_row(const RunRow& row);

  Environments& environments_;
  int env_;
  bool over_ = false;
  std::uint64_t tick_ = 0;
  RunRecord record_;
  RowMaker rows_;
};

}  // namespace sandrunner::python
