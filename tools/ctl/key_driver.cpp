// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/key_driver.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace sandrunner::ctl {
namespace {

constexpr std::string_view kPasteBegins = "\x1b[200~", kPasteEnds = "\x1b[201~";
constexpr std::size_t kLongestSequence = 32;  // what is longer is none

// At scale 1; null: this is no steering key.
const VelocityCommand* steered_by(char key) {
  static constexpr std::pair<char, VelocityCommand> kKeys[] = {
      {'w', {.vx_mps = kFullSpeed.vx_mps}},     {'s', {.vx_mps = -kFullSpeed.vx_mps}},
      {'a', {.vy_mps = kFullSpeed.vy_mps}},     {'d', {.vy_mps = -kFullSpeed.vy_mps}},
      {'q', {.wz_radps = kFullSpeed.wz_radps}}, {'e', {.wz_radps = -kFullSpeed.wz_radps}},
  };
  for (const auto& [of, velocity] : kKeys) {
    if (of == key) return &velocity;
  }
  return nullptr;
}

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
  if (const VelocityCommand* const steered = steered_by(key)) {
    steered_ = steered;
    last_ns_ = now_ns;
  } else if (key == '+' || key == '=') {
    rescale(scale_tenths_ + 1, now_ns);
  } else if (key == '-') {
    rescale(scale_tenths_ - 1, now_ns);
  } else if (key == kKeyEscape || key == kKeyCtrlC) {
    steered_ = nullptr;
    return {.quits = true};
  } else {
    for (const RequestRow& row : kRequestTable) {
      if (row.key == '\0' || row.key != key) continue;
      steered_ = nullptr;
      return {.request = &row};
    }
  }
  return {};
}

void KeyDriver::rescale(int tenths, std::int64_t now_ns) {
  // Not for a key that is no longer in force: it would start again.
  if (command(now_ns)) last_ns_ = now_ns;
  scale_tenths_ = std::clamp(tenths, 1, 20);
}

std::optional<VelocityCommand> KeyDriver::command(std::int64_t now_ns) const {
  if (!steered_ || now_ns - last_ns_ >= kHold_ns) return std::nullopt;
  const double scale = 0.1 * scale_tenths_;
  return VelocityCommand{scale * steered_->vx_mps, scale * steered_->vy_mps,
                         scale * steered_->wz_radps};
}

}  // namespace sandrunner::ctl
