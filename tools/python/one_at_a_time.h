// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "rt/base/errors.h"

namespace sandrunner::python {

/// Refuses a second call while one is in progress, which only another Python thread can make.
class OneAtATime {
 public:
  /// Throws InputError.
  explicit OneAtATime(std::atomic<bool>& busy) : busy_(busy) {
    if (busy.exchange(true)) {
      throw InputError(
          "sandrunner: found a call while another thread's is in progress, expected one at a time");
    }
  }
  ~OneAtATime() { busy_ = false; }
  OneAtATime(const OneAtATime&) = delete;
  OneAtATime& operator=(const OneAtATime&) = delete;

 private:
  std::atomic<bool>& busy_;
};

/// The method, as a function for Python that refuses to run while another call is in progress.
template <typename Object, typename... Arguments>
auto alone(void (Object::*method)(Arguments...)) {
  return [method](Object& object, Arguments... arguments) {
    const OneAtATime lock(object.busy());
    (object.*method)(arguments...);
  };
}

}  // namespace sandrunner::python
