// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "drivers/check/bus_scan.h"
#include "drivers/check/check_report.h"
#include "drivers/check/hand_move.h"
#include "drivers/check/nudge.h"
#include "drivers/check/signals_as_stop.h"
#include "drivers/check/zero.h"
#include "drivers/robot/bring_up.h"
#include "drivers/robot/bus_listen.h"
#include "drivers/robot/bus_plan.h"
#include "drivers/robot/emergency_stop.h"
#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/output_files.h"
#include "rt/base/standard_error.h"
#include "rt/base/typed_lines.h"
#include "rt/core/joint_pd.h"

namespace sandrunner {
namespace {

constexpr int kExchanges = 200;  // a second
constexpr int kExchangesPerPicture = 20;
constexpr std::uint64_t kSilent_ticks = kControlHz / 50;

class Check {
 public:
  explicit Check(const CanCheck& check)
      : task_(check.task),
        read_(check.read),
        robot_(check.robot),
        gate_(check.gate),
        config_(check.config) {}

  int run() {
    if (task_.nudge && !config_.hanging) {
      throw InputError(
          "check --nudge: hardware.hanging is false, expected true: hang the robot so that every "
          "joint is free, and no person within reach; then add --set hardware.hanging=true");
    }
    judge_plan();
    open_buses();
    open_emergency_stop();
    if (buses_are_ours()) {
      findings_.scanned = scan(config_, sockets_);
      add(scan_problems(config_, robot_, findings_.scanned));
      if (task_.move) {
        move_joints();
        lift_front();
      }
      if (task_.nudge) nudge_joints();
      if (task_.zero_pose_rad) calibrate();
    } else {
      for (auto& socket : sockets_) socket.reset();
    }
    measure();
    judge_emergency_stop();
    fmt::print("{}", check_report(config_, robot_, gate_, findings_));
    return findings_.problems.empty() ? kExitOk : kExitFailed;
  }

 private:
  void add(const std::vector<std::string>& problems) {
    findings_.problems.insert(findings_.problems.end(), problems.begin(), problems.end());
  }

  void judge_plan() {
    for (const PlannedBus& bus : plan_buses(config_)) {
      if (bus.overloaded() && !is_virtual(bus.interface)) {
        findings_.problems.push_back(overload(config_, bus));
      }
    }
  }

  /// Where a bus cannot be opened, the others are looked at.
  void open_buses() {
    for (const BusConfig& bus : config_.buses) {
      sockets_.push_back(nullptr);
      try {
        sockets_.back() = open_bus(bus);
      } catch (const InputError& error) {
        findings_.problems.emplace_back(error.what());
      }
    }
  }

  /// Before anything is sent: a robot that runs would fall if its drives received an off command.
  bool buses_are_ours() {
    const std::vector<std::string> problems =
        traffic_problems(config_, robot_, listen(config_, sockets_));
    add(problems);
    return problems.empty();
  }

  /// Exchanges until the person has typed a line; positions of each exchange, and the line.
  std::string watch(DriveLook& look, JointTrace& trace) {
    for (;;) {
      look.exchange();
      trace.push_back(look.position_rad());
      if (const auto line = lines_.next()) return *line;
      if (lines_.ended()) throw InputError("standard input: found its end, expected an answer");
    }
  }

  bool answers(const DriveLook& look, int j) const {
    const FoundDrive& drive = look.drives()[j];
    return 2 * drive.replies > drive.requests;
  }

  void move_joints() {
    DriveLook look(config_, sockets_);
    for (int i = 0; i < kLookExchanges; ++i) look.exchange();
    for (int j = 0; j < kNumJoints; ++j) {
      const std::string& joint = robot_.joint_names[j];
      if (!answers(look, j)) {
        findings_.moves.push_back(joint + ": not asked for, it does not answer");
        continue;
      }
      const std::string motion = positive_motion(robot_, task_.nominal_rad, j);
      to_standard_error(fmt::format(
          "\n{}: put it where it has room, and press Enter (s and Enter skips it)\n", joint));
      JointTrace ignored, trace;
      std::string line = watch(look, ignored);
      if (line.empty()) {
        to_standard_error(
            fmt::format("{}: turn it by hand by about 30 degrees so that, seen in the "
                        "standing pose, {}; hold it there and press Enter\n",
                        joint, motion));
        line = watch(look, trace);
      }
      if (!line.empty()) {
        findings_.moves.push_back(joint + ": skipped");
        continue;
      }
      const HandMove move = judge_move(trace, j);
      const std::string verdict = move_words(move, j, config_, robot_);
      to_standard_error(verdict + "\n");
      findings_.moves.push_back(verdict);
      if (move.verdict != HandMove::Verdict::kGood) findings_.problems.push_back(verdict);
    }
  }

  /// The specific force over the exchanges of a look, without what came before.
  static Vector3 specific_force(DriveLook& look, Imu& imu) {
    while (imu.poll(clock_ns(CLOCK_MONOTONIC))) {
    }
    ImuLook seen;
    for (int i = 0; i < kLookExchanges; ++i) {
      look.exchange();
      while (imu.poll(clock_ns(CLOCK_MONOTONIC))) seen.add(imu.sample());
    }
    return seen.figures(0, 0.0).acceleration_mps2;
  }

  void lift_front() {
    std::unique_ptr<Imu> imu;
    try {
      imu = std::make_unique<Imu>(config_.imu);
    } catch (const InputError&) {
      return;  // measure() reports it
    }
    DriveLook look(config_, sockets_);
    JointTrace ignored;
    to_standard_error("\nIMU: stand the robot level and press Enter (s and Enter skips it)\n");
    if (!watch(look, ignored).empty()) {
      findings_.moves.push_back("IMU: skipped");
      return;
    }
    const Vector3 level_mps2 = specific_force(look, *imu);
    to_standard_error(fmt::format(
        "IMU: lift the robot's front by about {:.0f} degrees; hold it there and press Enter\n",
        kAskedTilt_deg));
    watch(look, ignored);
    const FrontLift lift = judge_front_lift(level_mps2, specific_force(look, *imu));
    const std::string verdict = "IMU: " + lift.words;
    to_standard_error(verdict + "\n");
    findings_.moves.push_back(verdict);
    if (!lift.good) findings_.problems.push_back(verdict);
  }

  /// False: the robot is not as it has to be before anything is powered.
  bool may_be_powered() {
    DriveLook look(config_, sockets_);
    for (int i = 0; i < kLookExchanges; ++i) look.exchange();
    std::vector<std::string> problems =
        drive_problems(config_, robot_, gate_, sockets_, look.drives());
    if (emergency_stop_pressed()) problems.push_back(emergency_stop_words());
    const bool whole = std::ranges::all_of(sockets_, [](const auto& s) { return s != nullptr; });
    if (problems.empty() && whole) return true;
    findings_.problems.push_back(
        fmt::format("nothing was nudged: {}",
                    problems.empty() ? "a bus could not be opened" : problems.front()));
    return false;
  }

  NudgeState nudge_exchange(DriveLook& look, const NudgePoints& points) {
    NudgePoints sent = points;
    for (int j = 0; j < kNumJoints && config_.mode == DriveMode::kTorque; ++j) {
      const Drive& d = look.drive(j);
      if (!sent[j]) continue;
      const SetPoint& p = *sent[j];  // which the host evaluates
      sent[j] = SetPoint{.torque_nm = joint_torque(d.position_rad(), d.velocity_radps(),
                                                   p.position_rad, p.velocity_radps, p.kp_nmprad,
                                                   p.kd_nmsprad, p.torque_nm)};
    }
    look.exchange_powered(sent);
    NudgeState state;
    state.time_s = 1e-9 * static_cast<double>(clock_ns(CLOCK_MONOTONIC));
    for (int j = 0; j < kNumJoints; ++j) {
      const Drive& d = look.drive(j);
      state.position_rad[j] = d.position_rad();
      state.velocity_radps[j] = d.velocity_radps();
      state.torque_nm[j] = d.torque_nm();
      state.well[j] = d.fault() == 0 && look.tick() < d.tick() + kSilent_ticks;
    }
    state.stop =
        lines_.next() || lines_.ended() || emergency_stop_pressed() || SignalsAsStop::stopped();
    return state;
  }

  void nudge_joints() {
    if (!may_be_powered()) return;
    to_standard_error(
        "\nEach drive will push its joint a little, by about 0.1 rad. The robot hangs, every joint "
        "is free, no person is within reach.\nIf another joint moves than the one that is named, "
        "or "
        "another way: press Enter at once, it stops. Enter begins (s and Enter skips it)\n");
    DriveLook look(config_, sockets_);
    JointTrace ignored;
    if (!watch(look, ignored).empty()) return;
    findings_.powered = true;
    const SignalsAsStop signals;
    const NudgeExchange exchange = [&](const NudgePoints& points) {
      return nudge_exchange(look, points);
    };
    JointArray<bool> good{};
    bool stopped = false;
    // Each leg from its foot up: what hangs on a joint that is pushed is damped by then.
    for (int i = 0; i < kNumJoints && !stopped; ++i) {
      const int j = i + kJointsPerLeg - 1 - 2 * (i % kJointsPerLeg);
      const double most_nm = std::min(kNudge_nm, gate_.torque_limit_nm[j]);
      to_standard_error(fmt::format("{} moves now so that, seen in the standing pose, {}\n",
                                    robot_.joint_names[j],
                                    positive_motion(robot_, task_.nominal_rad, j)));
      Nudge result = nudge(j, most_nm, good, exchange);
      if (result.verdict == Nudge::Verdict::kNotMoved) {
        to_standard_error(
            fmt::format("{} moves now the other way: a stop may be near\n", robot_.joint_names[j]));
        result = nudge(j, -most_nm, good, exchange);
      }
      const std::string verdict = nudge_words(result, j, config_, robot_);
      to_standard_error(verdict + "\n");
      findings_.nudges.push_back(verdict);
      good[j] = result.verdict == Nudge::Verdict::kGood;
      stopped = result.verdict == Nudge::Verdict::kStopped;
      if (!good[j]) findings_.problems.push_back(verdict);
    }
    for (int i = 0; i < kLookExchanges; ++i) look.exchange_powered({});
  }

  void calibrate() {
    std::string pose;
    for (int j = 0; j < kNumJoints; ++j) {
      pose +=
          fmt::format("  {:<14}{:8.4f} rad\n", robot_.joint_names[j], (*task_.zero_pose_rad)[j]);
    }
    DriveLook look(config_, sockets_);
    JointTrace ignored, trace;
    to_standard_error(
        fmt::format("\nHold the robot in this pose and press Enter (s and Enter leaves the zeros "
                    "as they are)\n{}",
                    pose));
    if (!watch(look, ignored).empty()) return;
    for (int i = 0; i < kExchanges; ++i) {
      look.exchange();
      trace.push_back(look.position_rad());
    }
    for (int j = 0; j < kNumJoints; ++j) {
      if (answers(look, j)) continue;
      throw InputError(
          fmt::format("--zero: {} does not answer: nothing is written", robot_.joint_names[j]));
    }
    const JointArray<double> zeros = zeros_of(trace, *task_.zero_pose_rad, config_, robot_);
    const std::string text =
        with_zeros(read_input_file(task_.path, "a TOML file"), task_.path, zeros, robot_);
    HardwareConfig config = read_(text);
    write_file(task_.path, text);
    config_ = std::move(config);
    to_standard_error(
        fmt::format("wrote the zero_rad of {} drives to {}\n", kNumJoints, task_.path));
  }

  void open_emergency_stop() {
    if (config_.emergency_stop.chip.empty()) return;
    try {
      stop_line_.emplace(config_.emergency_stop);
    } catch (const InputError& error) {
      findings_.problems.emplace_back(error.what());
    }
  }

  /// Or it cannot be read. A robot without one has none pressed.
  bool emergency_stop_pressed() const {
    return !config_.emergency_stop.chip.empty() && !(stop_line_ && stop_line_->high() == true);
  }

  std::string emergency_stop_words() const {
    const StopLineConfig& c = config_.emergency_stop;
    if (c.chip.empty()) return "emergency stop: the file names no line (hardware.emergency_stop)";
    const char* state = !stop_line_                  ? "cannot be read"
                        : stop_line_->high() == true ? "not pressed"
                                                     : "PRESSED, or its wire is broken";
    return fmt::format("emergency stop, {} line {}: {}", c.chip, c.line, state);
  }

  void judge_emergency_stop() {
    findings_.emergency_stop = emergency_stop_words();
    if (stop_line_ && stop_line_->high() != true) {
      findings_.problems.push_back(findings_.emergency_stop);
    }
  }

  void measure() {
    std::unique_ptr<Imu> imu;
    try {
      imu = std::make_unique<Imu>(config_.imu);
    } catch (const InputError& error) {
      findings_.problems.emplace_back(error.what());
    }
    DriveLook look(config_, sockets_);
    ImuLook imu_look;
    const Imu::Counters before = imu ? imu->counters() : Imu::Counters();
    const std::int64_t start_ns = clock_ns(CLOCK_MONOTONIC);
    const auto look_at_imu = [&] {
      while (imu->poll(clock_ns(CLOCK_MONOTONIC))) imu_look.add(imu->sample());
      const Imu::Counters now = imu->counters();
      findings_.imu = ImuFindings{
          .figures =
              imu_look.figures(now.samples - before.samples,
                               1e-9 * static_cast<double>(clock_ns(CLOCK_MONOTONIC) - start_ns)),
          .state = to_string(imu->state(clock_ns(CLOCK_MONOTONIC))),
          .bad_packets = now.bad_checksums - before.bad_checksums + now.repeated - before.repeated +
                         now.incomplete - before.incomplete};
    };
    const bool live = isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0;
    std::size_t drawn_lines = 0;
    bool enough = false;
    for (int i = 1; !enough; ++i) {
      look.exchange();
      if (imu) look_at_imu();
      enough = i >= kExchanges && (!live || lines_.next() || lines_.ended());
      if (live && i % kExchangesPerPicture == 0) drawn_lines = draw(look, drawn_lines);
    }
    findings_.drives = look.drives();
    add(drive_problems(config_, robot_, gate_, sockets_, look.drives()));
    add(bus_problems(config_, look.buses()));
    if (findings_.imu) add(imu_problems(config_.imu, *findings_.imu));
  }

  /// The joints and the IMU as they are now, over what was drawn before; returns its lines.
  std::size_t draw(const DriveLook& look, std::size_t drawn_lines) const {
    std::string picture = joint_table(config_, robot_, gate_, look.drives());
    if (findings_.imu) picture += imu_line(config_.imu, *findings_.imu);
    picture += emergency_stop_words() + "\nlive until Enter; nothing is powered\n";
    const std::string back = drawn_lines > 0 ? fmt::format("\x1b[{}A\x1b[J", drawn_lines) : "\n";
    to_standard_error(back + picture);
    return static_cast<std::size_t>(std::count(picture.begin(), picture.end(), '\n'));
  }

  const CheckTask& task_;
  const std::function<HardwareConfig(const std::string& text)>& read_;
  const RobotDescription& robot_;
  const GateConfig& gate_;
  HardwareConfig config_;
  CanSockets sockets_;
  Lines lines_;
  std::optional<StopLine> stop_line_;
  CheckFindings findings_;
};

}  // namespace

int run_check(const CanCheck& check) { return Check(check).run(); }

}  // namespace sandrunner
