// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/key_driver.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace sandrunner::ctl {
namespace {

constexpr std::string_view kPasteBegins = "\x1b[200~", kPasteEnds = "\x1b[201~";
constexpr std::size_t kLongestSequence = 32;  // what is longer is none

}  // namespace

std::vector<char> KeyReader::keys(std::string_view bytes) {
  const std::string text = std::exchange(rest_, {}).append(bytes);
  std::vector<char> keys;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool sequence =
        c == kKeyEscape && i + 1 < text.size() && (text[i + 1] == '[' || text[i + 1] == 'O');
    if (sequence) {
      // ESC [ parameters final, or ESC O final; finals are '@' to '~'.
      std::size_t end = i + 2;
      while (end < text.size() && (text[end] < '@' || text[end] > '~')) ++end;
      if (end == text.size()) {
        if (end - i <= kLongestSequence) rest_ = text.substr(i);
        break;
      }
      const std::string_view found = std::string_view(text).substr(i, end + 1 - i);
      if (found == kPasteBegins) pasting_ = true;
      if (found == kPasteEnds) pasting_ = false;
      i = end;
    } else if (pasting_) {
      // The end of the paste may be cut here.
      if (c == kKeyEscape && i + 1 == text.size()) rest_ = text.substr(i);
    } else {
      keys.push_back(c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
    }
  }
  return keys;
}

KeyAction KeyDriver::press(char key, std::int64_t now_ns) {
  switch (key) {
    case 'w':
    case 's':
    case 'a':
    case 'd':
    case 'q':
    case 'e':
      key_ = key;
      last_ns_ = now_ns;
      return {};
    case '+':
    case '=':
      rescale(scale_tenths_ + 1, now_ns);
      return {};
    case '-':
      rescale(scale_tenths_ - 1, now_ns);
      return {};
    case kKeyEscape:
    case kKeyCtrlC:
      key_ = '\0';
      return {.quits = true};
    default:
      break;
  }
  for (const RequestRow& row : kRequestTable) {
    if (row.key == '\0' || row.key != key) continue;
    key_ = '\0';
    return {.request = &row};
  }
  return {};
}

void KeyDriver::rescale(int tenths, std::int64_t now_ns) {
  // Not for a key that is no longer in force: it would start again.
  if (command(now_ns)) last_ns_ = now_ns;
  scale_tenths_ = std::clamp(tenths, 1, 20);
}

std::optional<VelocityCommand> KeyDriver::command(std::int64_t now_ns) const {
  if (key_ == '\0' || now_ns - last_ns_ >= kHold_ns) return std::nullopt;
  const double scale = 0.1 * scale_tenths_;
  const double vx_mps = scale * kFullSpeed.vx_mps;
  const double vy_mps = scale * kFullSpeed.vy_mps;
  const double wz_radps = scale * kFullSpeed.wz_radps;
  switch (key_) {
    case 'w':
      return VelocityCommand{.vx_mps = vx_mps};
    case 's':
      return VelocityCommand{.vx_mps = -vx_mps};
    case 'a':
      return VelocityCommand{.vy_mps = vy_mps};
    case 'd':
      return VelocityCommand{.vy_mps = -vy_mps};
    case 'q':
      return VelocityCommand{.wz_radps = wz_radps};
    default:
      return VelocityCommand{.wz_radps = -wz_radps};
  }
}

}  // namespace sandrunner::ctl
