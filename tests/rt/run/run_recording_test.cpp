// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rt/run/recording.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

TEST(RunRecordingTest, TicksThatNeverCameToItAreLostToo) {
  const TemporaryFolder folder;
  Options options;
  options.clock = RunClock::kRealtime;
  options.record_dir = folder.path("run");
  RunRecording recording(options, config_of("rigid"), "", PolicyRunner());
  std::vector<TickSink*> sinks;
  recording.add_to(sinks);
  ASSERT_EQ(sinks.size(), 1u);
  sinks[0]->begin(0);
  sinks[0]->add(example_tick(0));
  sinks[0]->end();
  EXPECT_EQ(recording.report(0).find("LOST"), std::string::npos);
  EXPECT_NE(recording.report(5).find("run.mcap; 5 ticks LOST"), std::string::npos);
}

}  // namespace
}  // namespace sandrunner
