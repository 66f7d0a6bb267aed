// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/robot_view.h"

#include <fmt/format.h>

#include <algorithm>

#include "rt/base/errors.h"
#include "rt/base/fixed_text.h"
#include "rt/base/quantile.h"
#include "rt/core/messages.h"
#include "rt/core/mode_machine.h"
#include "rt/telemetry/diagnostics.h"
#include "tools/ctl/interrupt.h"

namespace sandrunner::ctl {
namespace {

constexpr std::int64_t kRateWindow_ns = 3 * kSecond_ns;
constexpr std::size_t kRecentTicks = 2 * kControlHz;

std::string velocity_text(double vx_mps, double vy_mps, double wz_radps) {
  return fmt::format("{} {} m/s {} rad/s", fixed_text(vx_mps, 2), fixed_text(vy_mps, 2),
                     fixed_text(wz_radps, 2));
}

const char* mode_text(std::uint32_t mode) {
  return mode <= static_cast<std::uint32_t>(Mode::kFault) ? mode_name(static_cast<Mode>(mode))
                                                          : "unknown";
}

}  // namespace

void RateMeter::add(std::int64_t now_ns, std::uint64_t amount) {
  came_.emplace_back(now_ns, amount);
  while (came_.front().first < now_ns - kRateWindow_ns) came_.pop_front();
}

double RateMeter::hz(std::int64_t now_ns) const {
  const auto recent = std::find_if(came_.begin(), came_.end(), [&](const auto& c) {
    return c.first >= now_ns - kRateWindow_ns;
  });
  if (came_.end() - recent < 2 || came_.back().first == recent->first) return -1.0;
  std::uint64_t amount = 0;  // that came after the first one
  for (auto c = recent + 1; c != came_.end(); ++c) amount += c->second;
  return static_cast<double>(amount) * 1e9 /
         static_cast<double>(came_.back().first - recent->first);
}

void RobotView::add(const sandrunner_TickBatch& batch, std::int64_t now_ns) {
  came_ = true;
  last_ns_ = last_tick_ns_ = now_ns;
  rates_[kTicks].add(now_ns, batch.ticks._length);
  ++messages_;
  // A number that is not above the last one means that the robot was restarted.
  if (sequence_number_ != 0 && batch.sequence_number > sequence_number_) {
    lost_messages_ += batch.sequence_number - sequence_number_ - 1;
  }
  sequence_number_ = batch.sequence_number;
  for (std::uint32_t i = 0; i < batch.ticks._length; ++i) {
    tick_ = batch.ticks._buffer[i];
    skipped_ += tick_.skipped;
    const std::array<std::uint32_t, 3> time{tick_.late_ns, tick_.control_ns, tick_.write_ns};
    if (times_.size() < kRecentTicks) {
      times_.push_back(time);
    } else {
      times_[next_time_++ % kRecentTicks] = time;
    }
  }
}

void RobotView::add(const nav_msgs_msg_dds__Odometry_& odometry, std::int64_t now_ns) {
  count(kOdometry, now_ns);
  has_odometry_ = true;
  const auto& twist = odometry.twist.twist;
  speed_ = {twist.linear.x, twist.linear.y, twist.angular.z, odometry.pose.pose.position.z};
}

void RobotView::add(const diagnostic_msgs_msg_dds__DiagnosticArray_& array, std::int64_t now_ns) {
  for (std::uint32_t i = 0; i < array.status._length; ++i) {
    const auto& status = array.status._buffer[i];
    if (std::string(status.name) != "sandrunner") continue;
    count(kDiagnostics, now_ns);
    message_ = one_line(status.message ? status.message : "");
    robot_ = one_line(status.hardware_id ? status.hardware_id : "");
    diagnostics_.clear();
    for (std::uint32_t k = 0; k < status.values._length; ++k) {
      const auto& pair = status.values._buffer[k];
      diagnostics_[pair.key] = one_line(pair.value);
    }
  }
}

void RobotView::count(Rate topic, std::int64_t now_ns) {
  came_ = true;
  last_ns_ = now_ns;
  rates_[topic].add(now_ns);
}

bool RobotView::alive(std::int64_t now_ns) const {
  return came_ && now_ns - last_ns_ <= kSecond_ns;
}

std::string RobotView::value(const std::string& key) const {
  const auto found = diagnostics_.find(key);
  return found == diagnostics_.end() ? "-" : found->second;
}

bool RobotView::has_tick(std::int64_t now_ns) const {
  return !times_.empty() && now_ns - last_tick_ns_ <= kSecond_ns;
}

std::string RobotView::mode(std::int64_t now_ns) const {
  return has_tick(now_ns) ? mode_text(tick_.mode) : value("mode");
}

std::string RobotView::faults(std::int64_t now_ns) const {
  return has_tick(now_ns) ? fault_names(tick_.faults) : value("faults");
}

std::string RobotView::command(std::int64_t now_ns) const {
  if (!has_tick(now_ns)) return "-";
  std::string text = velocity_text(tick_.command[0], tick_.command[1], tick_.command[2]);
  if (tick_.command_share < 1.0f) {
    text += fmt::format(", held to {:.0f} %: more than the policy can follow",
                        100.0 * static_cast<double>(tick_.command_share));
  }
  return text;
}

std::string RobotView::recent(std::size_t part) const {
  if (times_.empty()) return "-";
  std::vector<double> values_us;
  for (const auto& time_ns : times_) values_us.push_back(1e-3 * time_ns[part]);
  std::ranges::sort(values_us);
  return fmt::format("p50 {:.1f}, p99 {:.1f}", quantile(values_us, 0.5), quantile(values_us, 0.99));
}

std::string RobotView::line(std::int64_t now_ns) const {
  if (!alive(now_ns)) return "no robot";
  return fmt::format("mode {}  faults {}  command {}", mode(now_ns), faults(now_ns),
                     command(now_ns));
}

std::string RobotView::screen(std::int64_t now_ns) const {
  if (!alive(now_ns)) return "no robot\n";
  std::string out;
  const auto row = [&](const char* name, const std::string& text) {
    out += fmt::format("{:<14} {}\n", name, text);
  };
  row("robot", robot_);
  row("condition", message_);
  row("mode", mode(now_ns));
  row("faults", faults(now_ns));
  row("of joints", value("fault_joints"));
  row("command", command(now_ns));
  row("speed", has_odometry_ ? fmt::format("{}, height {} m (estimated)",
                                           velocity_text(speed_[0], speed_[1], speed_[2]),
                                           fixed_text(speed_[3], 2))
                             : "-");
  constexpr std::array<const char*, kNumRates> kNames = {"joint_states", "imu/data",    "odom",
                                                         "tf",           "diagnostics", "ticks"};
  std::string rates;
  for (std::size_t i = 0; i < kNumRates; ++i) {
    const double hz = rates_[i].hz(now_ns);
    rates += fmt::format("{}{} {}", i == 0 ? "" : "  ", kNames[i],
                         hz < 0.0 ? "-" : fmt::format("{:.1f}", hz));
  }
  row("rates, Hz", rates);
  constexpr std::array<std::pair<const char*, const char*>, 3> kDeadlines = {
      {{"late, us", "tick_late_us"}, {"control, us", "control_us"}, {"write, us", "write_us"}}};
  for (std::size_t i = 0; i < kDeadlines.size(); ++i) {
    row(kDeadlines[i].first,
        fmt::format("last 2 s: {}  since the start: {}", recent(i), value(kDeadlines[i].second)));
  }
  row("slots missed",
      fmt::format("{} while watching, {} since the start",
                  times_.empty() ? "-" : std::to_string(skipped_), value("slots_missed")));
  row("messages lost",
      fmt::format("{} lost and {} received on sandrunner/ticks, {} not written by the robot",
                  lost_messages_, messages_, value("messages_not_written")));
  return out;
}

}  // namespace sandrunner::ctl
