// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "rt/report/run_record.h"

namespace sandrunner {

/// Data of a page, in an element that its program finds by the name. Without '<', or as JSON with
/// that escaped.
struct PageData {
  std::string id, text = {};
};

/// The page with the data in it, which opens from a disk and asks for nothing else.
std::string page_with(std::span<const PageData> data);

/// run.html: a run as a page that opens from a disk, with all that it needs in it. Rows are left
/// out until the page has at most `most_bytes`; it says so. `curve`: a learning curve that is drawn
/// above the run, as JSON: {title, x_label, x: [...], every: rows that each value is the mean of,
/// charts: [{title, unit, lines: [{name, values: [...]}]}]}; empty: none.
std::string run_page(const RunRecord& record, std::size_t most_bytes = 16'000'000,
                     std::string_view curve = {});

}  // namespace sandrunner
