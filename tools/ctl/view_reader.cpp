// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/view_reader.h"

#include "rt/telemetry/dds/tick_batches.h"
#include "tools/ctl/interrupt.h"

namespace sandrunner::ctl {
namespace {

constexpr int kDepth = 50;

}  // namespace

// Best effort, so that a viewer that falls behind costs the robot no retransmissions; ticks are
// reliable, so that a gap means a message that is really lost.
ViewReader::ViewReader(const DdsParticipant& participant)
    : readers_{
          participant.reader("rt/joint_states", sensor_msgs_msg_dds__JointState__desc, kDepth,
                             false),
          participant.reader("rt/imu/data", sensor_msgs_msg_dds__Imu__desc, kDepth, false),
          participant.reader("rt/odom", nav_msgs_msg_dds__Odometry__desc, kDepth, false),
          participant.reader("rt/tf", tf2_msgs_msg_dds__TFMessage__desc, kDepth, false),
          participant.reader("rt/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                             kDepth, false),
          participant.reader("sandrunner/ticks", sandrunner_TickBatch_desc, kBatchDepth, true)} {}

void ViewReader::take_into(RobotView& view) {
  const std::int64_t now_ns = steady_ns();
  for (const auto topic : {RobotView::kJointStates, RobotView::kImu, RobotView::kTf}) {
    take(readers_[topic],
         [&](const void*, const dds_sample_info_t&) { view.count(topic, now_ns); });
  }
  take(readers_[RobotView::kOdometry], [&](const void* m, const dds_sample_info_t&) {
    view.add(*static_cast<const nav_msgs_msg_dds__Odometry_*>(m), now_ns);
  });
  take(readers_[RobotView::kDiagnostics], [&](const void* m, const dds_sample_info_t&) {
    view.add(*static_cast<const diagnostic_msgs_msg_dds__DiagnosticArray_*>(m), now_ns);
  });
  take(readers_[RobotView::kTicks], [&](const void* m, const dds_sample_info_t&) {
    view.add(*static_cast<const sandrunner_TickBatch*>(m), now_ns);
  });
}

}  // namespace sandrunner::ctl
