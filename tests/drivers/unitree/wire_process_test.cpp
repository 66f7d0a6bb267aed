// SPDX-License-Identifier: BSD-3-Clause
// The wire's process between a controller, which is another process, and a robot's end of the DDS
// topics on this computer, which is this one.
#include "drivers/unitree/wire_process.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"
#include "tests/rt/dds/own_domain.h"
#include "tests/support/joint_names.h"
#include "tests/support/temporary_folder.h"
#include "tools/hil/emulated/unitree_peer.h"

namespace sandrunner::unitree {
namespace {

using hil::UnitreePeer;

constexpr double kKp = 31.0, kDampingKd = 2.5;

/// Another domain in each test: the wire of the one before may still damp its robot.
UnitreeConfig config_of_test() {
  static int domain = 0;
  static const testing::TestInfo* last = nullptr;
  const testing::TestInfo* const test = testing::UnitTest::GetInstance()->current_test_info();
  if (test != last) domain = own_domain();
  last = test;
  UnitreeConfig config;
  config.interface = "lo";
  config.domain = domain;
  return config;
}

RobotFigures robot_of_test() {
  RobotFigures robot;
  for (int j = 0; j < kNumJoints; ++j) robot.joint_names[j] = kJointNames[j];
  robot.lower_rad.fill(-3.0);
  robot.upper_rad.fill(3.0);
  robot.damping_kd_nmsprad.fill(kDampingKd);
  return robot;
}

RobotState healthy() {
  RobotState state;
  state.battery_percent = 80;
  state.remote.on = true;
  state.mode.fill(1);
  return state;
}

enum class Kind { kFollowed, kDamped, kOff };

struct Heard {
  Kind kind;
  double at_s;
};

/// What a controller of the test and the test share.
struct Shared {
  std::atomic<int> told{0};     ///< 0: nothing yet, 1: ready, 2: refused
  std::atomic<int> wish{0};     ///< what it is to do next
  std::atomic<pid_t> wire{0};   ///< the process that sends
  std::array<char, 1000> said;  ///< why it was refused
};
enum Wish : int { kCommand, kCut, kEnd };

class WireProcessTest : public testing::Test {
 protected:
  WireProcessTest() {
    void* const memory =
        mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    shared_ = new (memory) Shared;
  }
  ~WireProcessTest() override {
    if (controller_ > 0) {
      kill(controller_, SIGKILL);
      waitpid(controller_, nullptr, 0);
    }
  }

  /// Starts the controller with its wire, before this process has threads, then the robot's end.
  void start(const UnitreeConfig& config = config_of_test(), bool wrong_type = false) {
    const sched_param priority{.sched_priority = 60};
    sched_setscheduler(0, SCHED_FIFO, &priority);  // if it may: on a busy computer it matters
    controller_ = fork();
    if (controller_ == 0) control(config);
    robot_ = std::make_unique<UnitreePeer>(config_of_test(), wrong_type);
    start_ns_ = clock_ns(CLOCK_MONOTONIC);
  }
  /// The robot goes on until `done`, for 15 s at most. False: it never was.
  bool play(const std::function<bool()>& done, double limit_s = 15.0) {
    const double end_s = now_s() + limit_s;
    while (!done()) {
      if (now_s() > end_s) return false;
      step();
    }
    return true;
  }
  void play_for(double time_s) {
    const double end_s = now_s() + time_s;
    play([&] { return now_s() >= end_s; }, time_s + 1.0);
  }
  bool ready() {
    return play([&] { return shared_->told != 0; }) && shared_->told == 1;
  }
  std::string refusal() {
    play([&] { return shared_->told != 0; });
    return shared_->told == 2 ? shared_->said.data() : "not refused";
  }
  /// The first command of this kind that was heard after `since_s`; -1: none.
  double first_after(double since_s, Kind kind) const {
    for (const Heard& heard : heard_) {
      if (heard.at_s > since_s && heard.kind == kind) return heard.at_s;
    }
    return -1.0;
  }
  std::ptrdiff_t commands_after(double since_s) const {
    return std::ranges::count_if(heard_, [&](const Heard& h) { return h.at_s > since_s; });
  }
  double last_heard_s() const { return heard_.empty() ? -1.0 : heard_.back().at_s; }
  double now_s() const { return 1e-9 * static_cast<double>(clock_ns(CLOCK_MONOTONIC) - start_ns_); }

  /// The longest that this process, the robot, was held up since `since_s`: its clock then counts
  /// for nothing.
  double held_up_s(double since_s) const {
    double longest_s = 0.0;
    for (std::size_t i = 1; i < steps_s_.size(); ++i) {
      if (steps_s_[i] > since_s) longest_s = std::max(longest_s, steps_s_[i] - steps_s_[i - 1]);
    }
    return longest_s;
  }
  /// Does `fault` to a robot that is followed; expects damping in time, then off after 2 s,
  /// then nothing. What this computer held up the robot by counts for nothing.
  void expect_damping_after(const std::function<void()>& fault, double within_s = 0.052) {
    ASSERT_TRUE(ready());
    ASSERT_TRUE(play([&] { return first_after(0.0, Kind::kFollowed) > 0.0; }));
    play_for(0.2);
    const double fault_s = now_s();
    fault();
    play_for(2.5 + within_s);
    const double damped_s = first_after(fault_s, Kind::kDamped);
    ASSERT_GT(damped_s, 0.0);
    EXPECT_LE(damped_s - fault_s, within_s + 0.002 + held_up_s(fault_s));
    EXPECT_EQ(first_after(damped_s, Kind::kFollowed), -1.0);
    const double off_s = first_after(fault_s, Kind::kOff);
    EXPECT_NEAR(off_s - damped_s, 2.0, 0.1 + held_up_s(fault_s));
    const double end_s = last_heard_s();
    EXPECT_LE(end_s - off_s, 0.03 + held_up_s(fault_s));
    EXPECT_GT(now_s() - end_s, 0.2);
    EXPECT_EQ(mistakes_, 0);
  }

  std::unique_ptr<UnitreePeer> robot_;
  RobotState state_ = healthy();
  bool silent_ = false;  ///< the robot sends no states
  pid_t controller_ = 0;
  Shared* shared_ = nullptr;
  int mistakes_ = 0;

 private:
  /// The controller's life: 4000 commands a second. Never returns.
  [[noreturn]] void control(const UnitreeConfig& config) {
    WireProcess wire(config, robot_of_test());
    try {
      wire.connect();
    } catch (const InputError& error) {
      const std::string text = error.what();
      std::copy_n(text.c_str(), std::min<std::size_t>(text.size() + 1, 999), shared_->said.begin());
      shared_->told = 2;
      while (true) pause();
    }
    shared_->wire = wire.memory().sender.load();
    shared_->told = 1;
    WireCommand command;
    command.enabled = 1;
    command.joints.kp_nmprad.fill(kKp);
    while (shared_->wish != kEnd) {
      command.written_ns = clock_ns(CLOCK_MONOTONIC);
      wire.memory().command.write(command);
      if (shared_->wish == kCut) wire.memory().cut = true;
      usleep(250);
    }
    wire.memory().ended = true;
    while (true) pause();
  }

  /// 500 a second whatever holds one up: a robot with fewer is refused.
  void step() {
    steps_s_.push_back(now_s());
    state_.tick_ms = 2 * static_cast<std::uint32_t>(steps_s_.size());
    LowState message;
    encode_state(state_, message);
    if (!silent_) robot_->publish(message);
    const double left_s = 1e-3 * state_.tick_ms - now_s();
    if (left_s > 0.0) usleep(static_cast<useconds_t>(1e6 * left_s));
    robot_->serve();
    robot_->take_commands([&](const LowCmd& command) {
      if (command_mistake(command, 1) != nullptr) ++mistakes_;
      const unitree_go_msg_dds__MotorCmd_& motor = command.motor_cmd[0];
      const Kind kind = motor.kp > 0.0F   ? Kind::kFollowed
                        : motor.kd > 0.0F ? Kind::kDamped
                                          : Kind::kOff;
      heard_.push_back({kind, now_s()});
    });
  }

  std::int64_t start_ns_ = 0;
  std::vector<Heard> heard_;
  std::vector<double> steps_s_;
};

TEST_F(WireProcessTest, SendsTheNewestCommand500TimesASecond) {
  start();
  ASSERT_TRUE(ready());
  ASSERT_TRUE(play([&] { return first_after(0.0, Kind::kFollowed) > 0.0; }));
  const double begin_s = now_s();
  play_for(1.0);
  const double took_s = now_s() - begin_s;
  EXPECT_EQ(mistakes_, 0);
  EXPECT_EQ(first_after(0.0, Kind::kDamped), -1.0);
  EXPECT_NEAR(static_cast<double>(commands_after(begin_s)) / took_s, 500.0, 75.0);
}

TEST_F(WireProcessTest, AKilledControllerEndsInDampingThenOff) {
  start();
  expect_damping_after([&] { kill(controller_, SIGKILL); });
}

TEST_F(WireProcessTest, AStoppedControllerEndsInDampingThenOff) {
  start();
  expect_damping_after([&] { kill(controller_, SIGSTOP); });
}

TEST_F(WireProcessTest, AControllerThatCrashesEndsInDampingThenOff) {
  start();
  expect_damping_after([&] { kill(controller_, SIGSEGV); });
}

TEST_F(WireProcessTest, NeitherNameNorSessionOfTheControllerIsThatOfItsGuards) {
  start();
  ASSERT_TRUE(ready());
  const std::string controller = read_file("/proc/self/comm").substr(0, 5);
  const pid_t wire = shared_->wire, guard = getpgid(wire);
  for (const pid_t process : {wire, guard}) {
    const std::string folder = "/proc/" + std::to_string(process);
    EXPECT_TRUE(read_file(folder + "/comm").starts_with("legs-"));
    const std::string line = read_file(folder + "/cmdline");
    EXPECT_TRUE(line.starts_with("legs-"));
    EXPECT_EQ(line.find(controller), std::string::npos) << line;
    EXPECT_EQ(getsid(process), guard);
  }
  EXPECT_NE(getsid(controller_), guard);
}

TEST_F(WireProcessTest, CutDrivesEndInDampingThenOff) {
  start();
  expect_damping_after([&] { shared_->wish = kCut; });
}

TEST_F(WireProcessTest, AKilledWireEndsInDampingByItsGuard) {
  start();
  // A participant of its own joins the domain first.
  expect_damping_after([&] { kill(shared_->wire, SIGKILL); }, 0.4);
}

TEST_F(WireProcessTest, AWireThatHangsIsKilledAndItsGuardDamps) {
  start();
  expect_damping_after([&] { kill(shared_->wire, SIGSTOP); }, 0.55);
}

TEST_F(WireProcessTest, AWireThatHangsAsTheControllerEndsLeavesNoStiffness) {
  start();
  expect_damping_after(
      [&] {
        kill(shared_->wire, SIGSTOP);
        shared_->wish = kEnd;
      },
      0.55);
}

TEST_F(WireProcessTest, AnEndedControllerLeavesTheMotorsOff) {
  start();
  ASSERT_TRUE(ready());
  play_for(0.2);
  const double end_s = now_s();
  shared_->wish = kEnd;
  play_for(0.5);
  EXPECT_GT(first_after(end_s, Kind::kOff), 0.0);
  EXPECT_EQ(first_after(end_s, Kind::kDamped), -1.0);
}

TEST_F(WireProcessTest, AnotherProgramsCommandEndsInAMomentOfDampingAndNoMore) {
  start();
  ASSERT_TRUE(ready());
  play_for(0.2);
  LowCmd foreign;
  encode_damping(1, {9.0, 9.0, 9.0}, foreign);
  const double fault_s = now_s();
  robot_->send_foreign(foreign);
  play_for(0.5);
  const double damped_s = first_after(fault_s, Kind::kDamped);
  ASSERT_GT(damped_s, 0.0);
  EXPECT_LE(damped_s - fault_s, 0.01 + held_up_s(fault_s));
  EXPECT_EQ(first_after(damped_s, Kind::kFollowed), -1.0);
  EXPECT_LE(last_heard_s() - damped_s, 0.02 + held_up_s(fault_s));
}

TEST_F(WireProcessTest, SportModeThatReturnsEndsTheCommands) {
  start();
  ASSERT_TRUE(ready());
  play_for(0.2);
  const double fault_s = now_s();
  robot_->mode = "mcf";
  play_for(2.0);
  EXPECT_GT(first_after(fault_s, Kind::kDamped), 0.0);
  EXPECT_GT(now_s() - last_heard_s(), 0.2);
}

TEST_F(WireProcessTest, SportModeIsReleasedUntilItStaysAway) {
  start();
  robot_->mode = "ai";
  robot_->returns = 1;
  ASSERT_TRUE(ready()) << shared_->said.data();
  EXPECT_EQ(robot_->releases, 2);
  EXPECT_EQ(robot_->mode, "");
}

TEST_F(WireProcessTest, SportModeOfARobotThatStandsIsNotReleased) {
  state_.position_rad.fill(-1.5);
  start();
  robot_->mode = "ai";
  EXPECT_NE(refusal().find("expected a robot that lies"), std::string::npos) << refusal();
  EXPECT_EQ(robot_->releases, 0);
}

TEST_F(WireProcessTest, NoStateNamesTheInterface) {
  silent_ = true;
  start();
  EXPECT_NE(refusal().find("found no state in 3 s on interface lo"), std::string::npos)
      << refusal();
}

TEST_F(WireProcessTest, AnUnknownInterfaceIsNamed) {
  UnitreeConfig config = config_of_test();
  config.interface = "nosuch0";
  start(config);
  EXPECT_NE(refusal().find("interface nosuch0"), std::string::npos) << refusal();
}

TEST_F(WireProcessTest, AnotherTypeIsNamed) {
  start(config_of_test(), true);
  EXPECT_NE(refusal().find("found another type than unitree_go::msg::dds_::LowState_"),
            std::string::npos)
      << refusal();
}

TEST_F(WireProcessTest, ARemoteThatIsOffIsRefused) {
  state_.remote.on = false;
  start();
  EXPECT_NE(refusal().find("remote control: found none"), std::string::npos) << refusal();
}

TEST_F(WireProcessTest, AServiceThatDoesNotAnswerIsNamed) {
  start();
  robot_->answers = false;
  EXPECT_NE(refusal().find("motion_switcher: found no answer"), std::string::npos) << refusal();
}

}  // namespace
}  // namespace sandrunner::unitree
