// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/gamepad_device.h"

#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstddef>
#include <filesystem>
#include <utility>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner::ctl {
namespace {

// The kernel's bit set of codes up to `kMax`.
template <int kMax>
struct Bits {
  static constexpr std::size_t kWordBits = sizeof(unsigned long) * CHAR_BIT;
  std::array<unsigned long, kMax / kWordBits + 1> words{};
  bool has(std::size_t code) const {
    return (words[code / kWordBits] >> (code % kWordBits) & 1u) != 0;
  }
};

}  // namespace

std::optional<GamepadDevice> GamepadDevice::find() {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/input", error)) {
    if (entry.path().filename().string().rfind("event", 0) == 0) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) {
    const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) continue;
    GamepadDevice device(fd);
    if (device.describe()) return device;
  }
  return std::nullopt;
}

GamepadDevice::GamepadDevice(GamepadDevice&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), name_(std::move(other.name_)), ranges_(other.ranges_) {}

GamepadDevice::~GamepadDevice() {
  if (fd_ >= 0) close(fd_);
}

bool GamepadDevice::describe() {
  Bits<KEY_MAX> keys;
  Bits<ABS_MAX> axes;
  if (ioctl(fd_, EVIOCGBIT(EV_KEY, sizeof keys.words), keys.words.data()) < 0 ||
      ioctl(fd_, EVIOCGBIT(EV_ABS, sizeof axes.words), axes.words.data()) < 0 ||
      !keys.has(BTN_GAMEPAD) || !keys.has(BTN_TL)) {
    return false;
  }
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    input_absinfo info{};
    if (!axes.has(Gamepad::kAxes[i]) || ioctl(fd_, EVIOCGABS(Gamepad::kAxes[i]), &info) < 0) {
      return false;
    }
    ranges_[i] = {.min = info.minimum, .max = info.maximum, .flat = info.flat};
  }
  char name[128] = "gamepad";
  ioctl(fd_, EVIOCGNAME(sizeof name - 1), name);
  name_ = one_line(name);
  return true;
}

bool GamepadDevice::read_into(Gamepad& gamepad) {
  input_event events[64];
  for (;;) {
    const ssize_t size = read(fd_, events, sizeof events);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return errno == EAGAIN;
    if (size == 0) return false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(size) / sizeof(input_event); ++i) {
      const input_event& e = events[i];
      gamepad.event(e.type, e.code, e.value);
      if (e.type != EV_SYN || e.code != SYN_DROPPED) continue;
      for (const std::uint16_t axis : Gamepad::kAxes) {
        input_absinfo info{};
        if (ioctl(fd_, EVIOCGABS(axis), &info) == 0) gamepad.event(EV_ABS, axis, info.value);
      }
    }
  }
}

}  // namespace sandrunner::ctl
