// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/operator_desk.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "rt/core/mode_machine.h"
#include "rt/operator/mode_requests.h"
#include "tests/support/wait_until.h"

namespace sandrunner {
namespace {

constexpr OperatorId kPage{1}, kPeer{2};

Twist forward(double vx_mps) { return {.linear_mps = {vx_mps, 0.0, 0.0}}; }

/// A controller that does what it is asked, in a thread of its own, and stands.
class WillingController {
 public:
  explicit WillingController(RemoteOperator& op)
      : thread_([this, &op] {
          Mode mode = Mode::kStand;
          for (std::uint64_t tick = 0; !end_; ++tick) {
            const OperatorCommand command = op.command(tick);
            vx_mps_ = command.velocity.vx_mps;
            if (command.request == ModeRequest::kWalk) mode = Mode::kWalk;
            if (command.request == ModeRequest::kDamp) mode = Mode::kDamping;
            op.advance({.mode = mode});
            ticks_ = tick + 1;
            std::this_thread::yield();
          }
        }) {
    while (ticks_ < 2) std::this_thread::yield();
  }
  double vx_mps() const { return vx_mps_; }  ///< asked for last
  bool go_on() const {
    const std::uint64_t end = ticks_ + 2;
    return wait_until([&] { return ticks_ >= end; });
  }
  ~WillingController() {
    end_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> end_{false};
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<double> vx_mps_{0.0};
  std::thread thread_;
};

struct OperatorDeskTest : testing::Test {
  // A velocity holds for longer than any test takes.
  RemoteOperator op{1'000'000'000'000};
  OperatorDesk desk{op, 60.0, nullptr, std::chrono::seconds(5)};
  WillingController controller{op};
};

TEST_F(OperatorDeskTest, OneOfTwoOperatorsHoldsTheVelocityAndTheOtherIsTold) {
  EXPECT_EQ(desk.drive(forward(0.5), 1, kPage), CommandVerdict::kAccepted);
  EXPECT_EQ(desk.drive(forward(0.5), 2, kPeer), CommandVerdict::kOtherPublisher);
  EXPECT_EQ(desk.drive(forward(NAN), 1, kPage), CommandVerdict::kNotFinite);
  EXPECT_EQ(desk.drive(forward(6.0), 1, kPage), CommandVerdict::kAbsurd);
  const CommandCounts counts = desk.counts();
  EXPECT_EQ(counts.accepted, 1u);
  EXPECT_EQ(counts.other_publisher, 1u);
  EXPECT_EQ(counts.not_finite, 1u);
  EXPECT_EQ(counts.absurd, 1u);
}

TEST_F(OperatorDeskTest, WhileSomebodyDrivesOnlyStopAndDampAreTakenFromOthers) {
  EXPECT_EQ(desk.drive(forward(0.5), 1, kPage), CommandVerdict::kAccepted);
  EXPECT_EQ(desk.request("walk", kPeer).text, "another operator drives the robot");
  EXPECT_EQ(desk.request("walk", kPage).text, "mode walk");
  EXPECT_TRUE(desk.request("stop", kPeer).accepted);
  EXPECT_EQ(desk.request("damp", kPeer).text, "mode damping");
  EXPECT_EQ(desk.last_request(), "damp: accepted: mode damping");
}

TEST_F(OperatorDeskTest, ARobotThatMayNotWalkIsRefusedWithTheReason) {
  const RequestDecision decision = decide("walk", Mode::kStand, "the robot hangs");
  EXPECT_EQ(decision.request, ModeRequest::kNone);
  EXPECT_STREQ(decision.refusal, "the robot hangs");
  EXPECT_EQ(decide("stand", Mode::kDamping, "the robot hangs").refusal, nullptr);
}

TEST_F(OperatorDeskTest, DisarmTakesTheDrivesOffOnlyWhereNothingIsCarried) {
  EXPECT_EQ(decide("disarm", Mode::kDamping, nullptr).request, ModeRequest::kPassive);
  for (const Mode mode :
       {Mode::kPassive, Mode::kStandUp, Mode::kStand, Mode::kWalk, Mode::kFault}) {
    EXPECT_NE(decide("disarm", mode, nullptr).refusal, nullptr) << mode_name(mode);
  }
  EXPECT_EQ(failure(ModeRequest::kPassive, Mode::kPassive), nullptr);
  EXPECT_NE(failure(ModeRequest::kPassive, Mode::kDamping), nullptr);
}

TEST(OperatorDeskFaultTest, AFaultThatArmingBringsUpIsNamedWithWhatToDo) {
  for (const Fault fault : {Fault::kJointMisplaced, Fault::kTilt}) {
    RemoteOperator op{1200};
    OperatorDesk desk{op, 60.0, nullptr, std::chrono::seconds(5)};
    std::atomic<bool> end{false};
    std::thread controller([&] {
      TickFacts facts;
      for (std::uint64_t tick = 0; !end; ++tick) {
        if (op.command(tick).request == ModeRequest::kArm) {
          facts = {.mode = Mode::kFault, .faults = fault_bit(fault), .first_fault = fault};
        }
        op.advance(facts);
        std::this_thread::yield();
      }
    });
    const std::string text = desk.request("arm", kPage).text;
    end = true;
    controller.join();
    EXPECT_TRUE(text.starts_with(std::string("a fault came up: ") + fault_name(fault))) << text;
    EXPECT_EQ(text.find("fold all legs by hand") != std::string::npos,
              fault == Fault::kJointMisplaced);
    EXPECT_LE(text.size(), 127u);  // of an answer over DDS
  }
}

TEST_F(OperatorDeskTest, AnObjectionHoldsForWhatDoesNotEndTheMotion) {
  const auto objection = [] { return std::string("two robots"); };
  EXPECT_EQ(desk.request("walk", kPeer, objection).text, "two robots");
  EXPECT_TRUE(desk.request("stop", kPeer, objection).accepted);
  EXPECT_EQ(desk.drive(forward(0.5), 2, kPeer, objection), CommandVerdict::kObjection);
  EXPECT_EQ(desk.drive(forward(0.5), 1, kPage), CommandVerdict::kAccepted);  // nobody held it
  EXPECT_EQ(desk.request("fly", kPeer).text,
            "unknown, expected arm, stand, walk, stop, lie, damp, disarm or reset_fault");
  EXPECT_EQ(desk.counts().requests_refused, 2u);
  EXPECT_EQ(desk.counts().objected, 1u);
}

TEST_F(OperatorDeskTest, AnObjectionToTheHoldersVelocityEndsTheOneBefore) {
  const auto objection = [] { return std::string("two robots"); };
  desk.drive(forward(0.5), 1, kPage);
  ASSERT_TRUE(wait_until([&] { return controller.vx_mps() == 0.5; }));
  desk.drive(forward(0.5), 2, kPeer, objection);  // not the holder
  ASSERT_TRUE(controller.go_on());
  EXPECT_EQ(controller.vx_mps(), 0.5);
  desk.drive(forward(0.0), 1, kPage, objection);
  EXPECT_TRUE(wait_until([&] { return controller.vx_mps() == 0.0; }));
}

TEST_F(OperatorDeskTest, OperatorsInManyThreadsLeaveOneHolder) {
  std::array<std::thread, 4> threads;
  std::atomic<int> holders{0};
  for (std::size_t i = 0; i < threads.size(); ++i) {
    threads[i] = std::thread([&, i] {
      int accepted = 0;
      for (int n = 0; n < 1000; ++n) {
        const OperatorId who{static_cast<std::uint8_t>(i)};
        if (desk.drive(forward(0.1), i, who) == CommandVerdict::kAccepted) ++accepted;
      }
      if (accepted > 0) ++holders;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(holders, 1);
  EXPECT_EQ(desk.counts().accepted, 1000u);
}

// The controller is this thread, which does not say for long that it has considered anything.
TEST(ModeRequestsTest, WalkDuringStandUpIsRefusedWithTheReason) {
  EXPECT_STREQ(decide("walk", Mode::kStandUp, nullptr).refusal,
               "the robot is still standing up, try again when it stands");
}

TEST(OperatorDeskOfASlowControllerTest, StopAndDampAndTheCountsDoNotWaitBehindAnotherRequest) {
  RemoteOperator op{1'000'000'000'000};
  OperatorDesk desk{op, 60.0, nullptr, std::chrono::seconds(20)};
  std::uint64_t tick = 0;
  const auto comes = [&](ModeRequest request) {
    return wait_until([&] { return op.command(tick++).request == request; });
  };
  op.command(tick++);
  RequestOutcome armed, damped;
  std::thread first([&] { armed = desk.request("arm", kPage); });
  EXPECT_TRUE(comes(ModeRequest::kArm));
  EXPECT_EQ(desk.drive(forward(0.0), 2, kPeer), CommandVerdict::kAccepted);
  EXPECT_EQ(desk.counts().accepted, 1u);
  EXPECT_EQ(desk.last_request(), "");
  std::thread second([&] { damped = desk.request("damp", kPeer); });
  EXPECT_TRUE(comes(ModeRequest::kDamp));
  op.advance({.mode = Mode::kPassive});
  first.join();
  second.join();
  EXPECT_EQ(armed.text, "a stop or damp came after it");
  EXPECT_EQ(damped.text, "mode passive");
}

}  // namespace
}  // namespace sandrunner
