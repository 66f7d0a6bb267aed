// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/report/run_row.h"

namespace sandrunner {

/// Appends `bytes` as base64.
void append_base64(std::string& text, std::string_view bytes);

/// Appends `bytes` as gzip, without name or time, as base64: the same text for the same bytes.
void append_gzip(std::string& text, std::string_view bytes);

/// Appends rows as a page takes them: number by number, all rows of one before the next, each in
/// planes (the first bytes of all rows, then the second ones, ...), since bytes of one significance
/// are alike; then gzip and base64. Needs little memory besides `text`.
void append_rows(std::string& text, std::span<const RowField> fields,
                 std::span<const std::byte* const> rows);

template <typename Rows>
void append_rows(std::string& text, std::span<const RowField> fields, const Rows& rows) {
  std::vector<const std::byte*> starts;
  starts.reserve(rows.size());
  for (const auto& row : rows) starts.push_back(std::as_bytes(std::span(&row, 1)).data());
  append_rows(text, fields, std::span<const std::byte* const>(starts));
}

}  // namespace sandrunner
