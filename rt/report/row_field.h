// SPDX-License-Identifier: BSD-3-Clause
// The members of a row, as those need them who write its bytes: CSV, page and live view.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace sandrunner {

/// Some numbers of a row, next to each other; little-endian.
struct RowField {
  const char* name;
  const char* type;  ///< "f64", "f32", "u32", "i32" or "i16"
  std::size_t offset, count;
  /// Names of the numbers as columns of run.csv (run_csv.h); of a field that is in rows only.
  const char* columns = "";
  bool on_page = true;  ///< a page gets it; else it is for the CSV and figures alone

  /// Of one of the numbers, bytes.
  constexpr std::size_t width() const noexcept {
    const std::string_view bits = type + 1;
    return bits == "64" ? 8 : bits == "32" ? 4 : 2;
  }
};

inline constexpr bool kNotOnPage = false;

template <typename T>
struct RowElement {
  using Type = T;
  static constexpr std::size_t kCount = 1;
};
template <typename T, std::size_t kSize>
struct RowElement<std::array<T, kSize>> : RowElement<T> {
  static constexpr std::size_t kCount = kSize * RowElement<T>::kCount;
};

template <typename Member>
constexpr RowField row_field(const char* name, std::size_t offset, const char* columns = "",
                             bool on_page = true) {
  using Type = typename RowElement<Member>::Type;
  const char* type = nullptr;
  if constexpr (std::is_same_v<Type, double>) {
    type = "f64";
  } else if constexpr (std::is_same_v<Type, float>) {
    type = "f32";
  } else if constexpr (std::is_same_v<Type, std::uint32_t>) {
    type = "u32";
  } else if constexpr (std::is_same_v<Type, std::int32_t>) {
    type = "i32";
  } else {
    static_assert(std::is_same_v<Type, std::int16_t>);
    type = "i16";
  }
  return {name, type, offset, RowElement<Member>::kCount, columns, on_page};
}

// The compiler finds place, size and type of a member: a name cannot stand for another's values.
#define SANDRUNNER_ROW_FIELD(Row, member, ...) \
  row_field<decltype(Row::member)>(#member, offsetof(Row, member) __VA_OPT__(, ) __VA_ARGS__)

/// Whether the fields are all members of the row, in their order.
template <typename Row, std::size_t kFields>
constexpr bool covers_row(const std::array<RowField, kFields>& fields) {
  std::size_t end = 0;
  for (const RowField& field : fields) {
    if (field.offset != end) return false;
    end += field.count * field.width();
  }
  return sizeof(Row) - end < alignof(Row);  // nothing behind the last but padding
}

}  // namespace sandrunner
