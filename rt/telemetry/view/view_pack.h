// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/report/run_row.h"

namespace sandrunner {

/// gzip, without name or time: the same bytes for the same bytes.
std::string gzip(std::string_view bytes);

std::string base64(std::string_view bytes);

/// Rows as a page takes them: number by number, all rows of one before the next, each in planes
/// (the first bytes of all rows, then the second ones, ...), since bytes of one significance are
/// alike; then gzip and base64. `rows` is a whole number of rows of `row_bytes`.
std::string pack_rows(std::span<const RowField> fields, std::span<const std::byte> rows,
                      std::size_t row_bytes);

template <typename Row>
std::string pack_rows(std::span<const RowField> fields, const std::vector<Row>& rows) {
  return pack_rows(fields, std::as_bytes(std::span(rows)), sizeof(Row));
}

}  // namespace sandrunner
