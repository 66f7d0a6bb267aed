// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/moteus/moteus_frame.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/drives/nearest_code.h"

namespace sandrunner {
namespace {

constexpr std::uint8_t kNop = 0x50;
constexpr std::uint32_t kReplyBit = 0x8000;
constexpr std::uint32_t kMaxRegister = 0xFFFF;

// Counts a unit as int8, int16, int32.
using Scale = std::array<double, 3>;
constexpr Scale kWhole = {1.0, 1.0, 1.0};
constexpr Scale kRevolutions = {100.0, 1e4, 1e5};
constexpr Scale kRevolutionsPerSecond = {10.0, 4e3, 1e5};
constexpr Scale kNewtonMetres = {2.0, 100.0, 1e3};
constexpr Scale kShare = {127.0, 32767.0, 2147483647.0};
constexpr Scale kVolts = {2.0, 10.0, 1e3};
constexpr Scale kDegrees = {1.0, 10.0, 1e3};
constexpr Scale kSeconds = {100.0, 1e3, 1e6};
constexpr Scale kAmperes = {1.0, 10.0, 1e3};
constexpr Scale kWatts = {0.1, 20.0, 1e4};

constexpr Scale kPerSecondSquared = {20.0, 1e3, 1e5};
constexpr Scale kRadians = {127.0 / std::numbers::pi, 32767.0 / std::numbers::pi,
                            2147483647.0 / std::numbers::pi};

struct ScaledRegisters {
  MoteusRegister first, last;
  const Scale& scale;
};
// The others are whole numbers.
constexpr std::array kScaled = {
    ScaledRegisters{0x001, 0x001, kRevolutions},
    ScaledRegisters{0x002, 0x002, kRevolutionsPerSecond},
    ScaledRegisters{0x003, 0x003, kNewtonMetres},
    ScaledRegisters{0x004, 0x005, kAmperes},
    ScaledRegisters{0x006, 0x006, kRevolutions},
    ScaledRegisters{0x007, 0x007, kWatts},
    ScaledRegisters{0x00A, 0x00A, kDegrees},
    ScaledRegisters{0x00D, 0x00D, kVolts},
    ScaledRegisters{0x00E, 0x00E, kDegrees},
    ScaledRegisters{0x010, 0x012, kShare},
    ScaledRegisters{0x014, 0x016, kVolts},
    ScaledRegisters{0x018, 0x018, kRadians},
    ScaledRegisters{0x019, 0x01B, kVolts},
    ScaledRegisters{0x01C, 0x01D, kAmperes},
    ScaledRegisters{0x01E, 0x01E, kRevolutionsPerSecond},
    ScaledRegisters{0x020, 0x020, kRevolutions},
    ScaledRegisters{0x021, 0x021, kRevolutionsPerSecond},
    ScaledRegisters{0x022, 0x022, kNewtonMetres},
    ScaledRegisters{0x023, 0x024, kShare},
    ScaledRegisters{0x025, 0x025, kNewtonMetres},
    ScaledRegisters{0x026, 0x026, kRevolutions},
    ScaledRegisters{0x027, 0x027, kSeconds},
    ScaledRegisters{0x028, 0x028, kRevolutionsPerSecond},
    ScaledRegisters{0x029, 0x029, kPerSecondSquared},
    ScaledRegisters{0x02A, 0x02A, kVolts},
    ScaledRegisters{0x02B, 0x02B, kShare},
    ScaledRegisters{0x02C, 0x02C, kAmperes},
    ScaledRegisters{0x030, 0x034, kNewtonMetres},
    ScaledRegisters{0x038, 0x038, kRevolutions},
    ScaledRegisters{0x039, 0x039, kRevolutionsPerSecond},
    ScaledRegisters{0x03A, 0x03A, kNewtonMetres},
    ScaledRegisters{0x03B, 0x03B, kRevolutions},
    ScaledRegisters{0x03C, 0x03C, kRevolutionsPerSecond},
    ScaledRegisters{0x03D, 0x03D, kNewtonMetres},
    ScaledRegisters{0x130, 0x131, kRevolutions},
};

const Scale& scale_of(MoteusRegister reg) noexcept {
  for (const ScaledRegisters& scaled : kScaled) {
    if (reg >= scaled.first && reg <= scaled.last) return scaled.scale;
  }
  return kWhole;
}

constexpr int width(MoteusFormat format) noexcept {
  return format == MoteusFormat::kInt8 ? 1 : format == MoteusFormat::kInt16 ? 2 : 4;
}

// The most negative of an integer format, which means unset.
constexpr std::int32_t unset_code(MoteusFormat format) noexcept {
  switch (format) {
    case MoteusFormat::kInt8:
      return std::numeric_limits<std::int8_t>::min();
    case MoteusFormat::kInt16:
      return std::numeric_limits<std::int16_t>::min();
    default:
      return std::numeric_limits<std::int32_t>::min();
  }
}

std::uint32_t encode_value(double value, MoteusFormat format, MoteusRegister reg) noexcept {
  if (format == MoteusFormat::kFloat) {
    if (!std::isfinite(value)) {
      return std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN());
    }
    constexpr double kMax = std::numeric_limits<float>::max();
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::clamp(value, -kMax, kMax)));
  }
  const std::int32_t unset = unset_code(format);
  if (!std::isfinite(value)) return static_cast<std::uint32_t>(unset);
  const double max = -(unset + 1.0);
  const double scaled = value * scale_of(reg)[static_cast<std::size_t>(format)];
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(nearest_code(scaled, -max, max)));
}

double decode_value(std::uint32_t bits, MoteusFormat format, MoteusRegister reg) noexcept {
  if (format == MoteusFormat::kFloat) return std::bit_cast<float>(bits);
  const int shift = 32 - 8 * width(format);
  const auto code = static_cast<std::int32_t>(bits << shift) >> shift;
  if (code == unset_code(format)) return std::numeric_limits<double>::quiet_NaN();
  return code / scale_of(reg)[static_cast<std::size_t>(format)];
}

}  // namespace

void set_moteus_address(const MoteusAddress& address, CanFrame& frame) noexcept {
  frame.id = (address.prefix & 0x1FFFu) << 16 | (address.wants_reply ? kReplyBit : 0) |
             (address.source & 0x7Fu) << 8 | (address.destination & 0x7Fu);
  frame.extended = frame.id > kMaxStandardId;
}

MoteusAddress moteus_address(const CanFrame& frame) noexcept {
  MoteusAddress address;
  address.source = frame.id >> 8 & 0x7F;
  address.destination = frame.id & 0x7F;
  address.wants_reply = (frame.id & kReplyBit) != 0;
  address.prefix = frame.id >> 16 & 0x1FFF;
  return address;
}

MoteusWriter::MoteusWriter(CanFrame& frame) noexcept : frame_(frame) {
  frame_.fd = frame_.brs = true;
  frame_.error = false;
  frame_.length = 0;
  frame_.data = {};
}

void MoteusWriter::byte(std::uint32_t value) noexcept {
  if (length_ == kMaxFdBytes) fits_ = false;
  if (fits_) frame_.data[length_++] = static_cast<std::uint8_t>(value);
}

// Seven bits a byte, the low ones first; the high bit says that more follow.
void MoteusWriter::number(std::uint32_t value) noexcept {
  for (; value > 0x7F; value >>= 7) byte((value & 0x7F) | 0x80);
  byte(value);
}

void MoteusWriter::header(MoteusOperation operation, MoteusFormat format, std::size_t count,
                          MoteusRegister start) noexcept {
  if (count == 0 || count > kMaxFdBytes) fits_ = false;
  const auto first = static_cast<std::uint32_t>(operation) | static_cast<std::uint32_t>(format)
                                                                 << 2;
  if (count <= 3) {
    byte(first | static_cast<std::uint32_t>(count));
  } else {
    byte(first);
    number(static_cast<std::uint32_t>(count));
  }
  number(start);
}

void MoteusWriter::values(MoteusOperation operation, MoteusFormat format, MoteusRegister start,
                          std::span<const double> values) noexcept {
  header(operation, format, values.size(), start);
  MoteusRegister reg = start;
  for (const double value : values) {
    const std::uint32_t bits = encode_value(value, format, reg++);
    for (int i = 0; i < width(format); ++i) byte(bits >> 8 * i & 0xFF);
  }
}

void MoteusWriter::read(const MoteusRead& read) noexcept {
  header(MoteusOperation::kRead, read.format, read.count, read.start);
}

void MoteusWriter::error(MoteusOperation operation, MoteusRegister reg,
                         std::uint32_t code) noexcept {
  byte(static_cast<std::uint32_t>(operation));
  number(reg);
  number(code);
}

bool MoteusWriter::finish() noexcept {
  frame_.length = static_cast<std::uint8_t>(can_fd_length(length_));
  std::fill(frame_.data.begin() + length_, frame_.data.begin() + frame_.length, kNop);
  return fits_;
}

MoteusReader::MoteusReader(const CanFrame& frame) noexcept
    : frame_(frame), length_(std::min<int>(frame.length, kMaxFdBytes)) {}

bool MoteusReader::stop(MoteusStatus status) noexcept {
  status_ = status;
  at_ = length_;
  remaining_ = 0;
  return false;
}

bool MoteusReader::number(std::uint32_t& value) noexcept {
  std::uint64_t sum = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    if (at_ >= length_) return stop(MoteusStatus::kTruncated);
    const std::uint8_t next = frame_.data[at_++];
    sum |= std::uint64_t{next & 0x7Fu} << shift;
    if (next < 0x80) {
      if (sum > std::numeric_limits<std::uint32_t>::max()) break;
      value = static_cast<std::uint32_t>(sum);
      return true;
    }
  }
  return stop(MoteusStatus::kBadNumber);
}

bool MoteusReader::value(double& value) noexcept {
  const int bytes = width(item_.format);
  if (at_ + bytes > length_) return stop(MoteusStatus::kTruncated);
  std::uint32_t bits = 0;
  for (int i = 0; i < bytes; ++i) bits |= std::uint32_t{frame_.data[at_++]} << 8 * i;
  value = decode_value(bits, item_.format, item_.reg);
  return true;
}

bool MoteusReader::start_subframe() noexcept {
  const std::uint8_t first = frame_.data[at_++];
  std::uint32_t start = 0;
  const bool is_error = first == static_cast<std::uint8_t>(MoteusOperation::kWriteError) ||
                        first == static_cast<std::uint8_t>(MoteusOperation::kReadError);
  if (first >= 0x30 && !is_error) return stop(MoteusStatus::kUnknownSubframe);
  item_ = {};
  remaining_ = 1;
  if (is_error) {
    item_.operation = static_cast<MoteusOperation>(first);
  } else {
    item_.operation = static_cast<MoteusOperation>(first & 0x30);
    item_.format = static_cast<MoteusFormat>(first >> 2 & 0x3);
    remaining_ = first & 0x3;
    if (remaining_ == 0 && !number(remaining_)) return false;
    if (remaining_ == 0) return stop(MoteusStatus::kBadNumber);
  }
  if (!number(start)) return false;
  if (remaining_ > kMaxFdBytes || start > kMaxRegister + 1 - remaining_) {
    return stop(MoteusStatus::kBadNumber);
  }
  item_.reg = static_cast<MoteusRegister>(start);
  return true;
}

bool MoteusReader::next(MoteusItem& item) noexcept {
  if (remaining_ == 0) {
    while (at_ < length_ && frame_.data[at_] == kNop) ++at_;
    if (at_ >= length_ || !start_subframe()) return false;
  } else {
    ++item_.reg;
  }
  switch (item_.operation) {
    case MoteusOperation::kRead:
      item_.value = std::numeric_limits<double>::quiet_NaN();
      break;
    case MoteusOperation::kWrite:
    case MoteusOperation::kReply:
      if (!value(item_.value)) return false;
      break;
    case MoteusOperation::kWriteError:
    case MoteusOperation::kReadError: {
      std::uint32_t code = 0;
      if (!number(code)) return false;
      item_.value = code;
      break;
    }
  }
  --remaining_;
  item = item_;
  return true;
}

}  // namespace sandrunner
