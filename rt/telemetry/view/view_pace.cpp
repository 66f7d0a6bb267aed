// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_pace.h"

#include <algorithm>

#include "rt/core/messages.h"

namespace sandrunner {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kLook{20};         // how often a wait looks at the interrupt
constexpr milliseconds kTooShort{1};      // waits that are not worth a system call
constexpr milliseconds kNotCaughtUp{50};  // a machine that is this late does not hurry afterwards

}  // namespace

void ViewPace::wait() {
  std::unique_lock lock(mutex_);
  const auto interrupted = [&] { return interrupts_.load(std::memory_order_relaxed) > 0; };
  if (status_.paused) {
    while (status_.paused && steps_ == 0 && !interrupted()) changed_.wait_for(lock, kLook);
    if (status_.paused && steps_ > 0) --steps_;
    due_ = Clock::now();
    return;
  }
  const std::chrono::duration<double> period(kControlPeriod_s / status_.rate);
  due_ = std::max(due_ + std::chrono::duration_cast<Clock::duration>(period),
                  Clock::now() - kNotCaughtUp);
  if (due_ - Clock::now() < kTooShort) return;
  while (Clock::now() < due_ && !status_.paused && !interrupted()) {
    changed_.wait_until(lock, std::min(due_, Clock::now() + kLook));
  }
}

void ViewPace::set_rate(double rate) {
  const std::lock_guard lock(mutex_);
  status_.rate = rate;
  due_ = Clock::now();
  changed_.notify_all();
}

void ViewPace::pause(bool on) {
  const std::lock_guard lock(mutex_);
  status_.paused = on;
  steps_ = 0;
  changed_.notify_all();
}

void ViewPace::step(int ticks) {
  const std::lock_guard lock(mutex_);
  status_.paused = true;
  steps_ = ticks;
  changed_.notify_all();
}

ViewPace::Status ViewPace::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

}  // namespace sandrunner
