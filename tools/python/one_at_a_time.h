// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

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

/// The same, and other Python threads run meanwhile. The lock is taken before they may: calls that
/// keep them out are never in its way.
template <typename Object, typename... Arguments>
auto alone_for_long(void (Object::*method)(Arguments...)) {
  return [method](Object& object, Arguments... arguments) {
    const OneAtATime lock(object.busy());
    const pybind11::gil_scoped_release release;
    (object.*method)(arguments...);
  };
}

}  // namespace sandrunner::python
