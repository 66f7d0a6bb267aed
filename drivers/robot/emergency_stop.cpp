// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/emergency_stop.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/gpio.h>
#include <pthread.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kOpen = std::numeric_limits<std::int64_t>::min();

}  // namespace

StopLine::StopLine(const StopLineConfig& config) {
  const auto fail = [&](const char* what) {
    throw InputError(fmt::format("hardware.emergency_stop: {} line {}: {}: {}", config.chip,
                                 config.line, what, strerror(errno)));
  };
  const int chip = open(config.chip.c_str(), O_RDONLY | O_CLOEXEC);
  if (chip < 0) fail("the chip cannot be opened");
  gpio_v2_line_request request{};
  request.offsets[0] = static_cast<std::uint32_t>(config.line);
  request.num_lines = 1;
  request.config.flags = GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN;
  std::strncpy(request.consumer, "sandrunner emergency stop", sizeof request.consumer - 1);
  const int result = ioctl(chip, GPIO_V2_GET_LINE_IOCTL, &request);
  const int error = errno;
  close(chip);
  errno = error;
  if (result != 0) fail("it is no line that can be read, or another program has it");
  descriptor_ = request.fd;
}

StopLine::~StopLine() { close(descriptor_); }

std::optional<bool> StopLine::high() const noexcept {
  gpio_v2_line_values values{.bits = 0, .mask = 1};
  if (ioctl(descriptor_, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) != 0) return std::nullopt;
  return (values.bits & 1) != 0;
}

EmergencyStop::EmergencyStop(Read high) : high_(std::move(high)), closed_ns_(kOpen) {
  look();
  thread_ = std::thread([this] { run(); });
}

EmergencyStop::~EmergencyStop() {
  end_ = true;
  thread_.join();
}

void EmergencyStop::look() noexcept {
  const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);  // before it: a slow chip ages the answer
  const bool closed = high_() == std::optional(true);
  closed_ns_.store(closed ? now_ns : kOpen, std::memory_order_relaxed);
}

void EmergencyStop::run() noexcept {
  // Without the right to it the control thread has none either, and says so.
  const sched_param priority{.sched_priority = kPriority};
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  while (!end_) {
    look();
    const timespec pause{.tv_sec = 0, .tv_nsec = kPeriod_ns};
    nanosleep(&pause, nullptr);
  }
}

bool EmergencyStop::pressed(std::int64_t now_ns) const noexcept {
  const std::int64_t closed_ns = closed_ns_.load(std::memory_order_relaxed);
  return closed_ns == kOpen || now_ns - closed_ns > kLongest_ns;
}

}  // namespace sandrunner
