// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/slower_rate.h"
#include "rt/loop/tick_sink.h"

namespace sandrunner {

/// A line on the terminal of standard error, twice a second, that is gone at the end.
class ProgressLine final : public TickSink {
 public:
  void add(const TickRecord& tick) override;
  void end() override;

 private:
  SlowerRate rate_{2};
};

}  // namespace sandrunner
