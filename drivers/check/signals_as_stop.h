// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <csignal>

namespace sandrunner {

/// While one exists, a signal that asks this process to end or to pause (Ctrl-C, Ctrl-Z, a closed
/// terminal, kill) does no more than be noted: drives that have torque are switched off first. At
/// its end the last one is acted on. One at a time.
class SignalsAsStop {
 public:
  SignalsAsStop() noexcept {
    noted_ = 0;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      before_[i] = std::signal(kSignals[i], [](int number) { noted_ = number; });
    }
  }
  ~SignalsAsStop() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) std::signal(kSignals[i], before_[i]);
    if (noted_ != 0) std::raise(noted_);
  }
  SignalsAsStop(const SignalsAsStop&) = delete;
  SignalsAsStop& operator=(const SignalsAsStop&) = delete;

  static bool stopped() noexcept { return noted_ != 0; }

 private:
  static constexpr std::array<int, 5> kSignals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP};
  static inline volatile std::sig_atomic_t noted_ = 0;
  std::array<void (*)(int), kSignals.size()> before_{};
};

}  // namespace sandrunner
