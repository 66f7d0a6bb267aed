// SPDX-License-Identifier: BSD-3-Clause
// A TickRecord word by word: the one description of its layout, from which a recording's schema is
// made and by which a replay names what differs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Some words of 64 bits in a row.
struct TickField {
  const char* name;
  std::size_t first_word;
  std::size_t words;
  char kind;  ///< 'd' double, 'u' and 'i' integer without and with a sign
};

inline constexpr std::size_t kTickWords = sizeof(TickRecord) / 8;
using TickWords = std::array<std::uint64_t, kTickWords>;
static_assert(sizeof(TickWords) == sizeof(TickRecord));

/// All fields, in the order of the record, without a gap.
std::span<const TickField> tick_fields();

/// The field that a word belongs to.
const TickField& tick_field_of(std::size_t word);

/// Name of a word: "joint_position_rad[3]", "tick".
std::string tick_word_name(std::size_t word);

/// OMG IDL of one tick and of a batch of them. The classic CDR of a batch, little-endian, is its
/// sequence number and the records' own bytes.
std::string tick_idl();

}  // namespace sandrunner
