// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/operator_desk.h"

#include <fmt/format.h>

#include <thread>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"
#include "rt/core/mode_machine.h"
#include "rt/loop/fault_remedy.h"

namespace sandrunner {
namespace {

constexpr auto kLookEvery = std::chrono::microseconds(250);
constexpr const char* kNoAnswer = "the controller does not answer";

}  // namespace

OperatorDesk::OperatorDesk(RemoteOperator& op, double stale_s, const char* no_walk,
                           std::chrono::milliseconds answer)
    : operator_(op),
      no_walk_(no_walk),
      answer_(answer),
      gate_(static_cast<std::int64_t>(stale_s * 1e9)) {}

CommandVerdict OperatorDesk::drive(const Twist& twist, std::uint64_t publisher,
                                   const OperatorId& who, const Objection& objection) {
  const bool objected = objection && !objection().empty();
  const std::lock_guard lock(mutex_);
  const CommandVerdict verdict = objected
                                     ? CommandVerdict::kObjection
                                     : gate_.judge(twist, publisher, clock_ns(CLOCK_MONOTONIC));
  switch (verdict) {
    case CommandVerdict::kAccepted:
      holder_ = who;
      asked_.velocity = {twist.linear_mps[0], twist.linear_mps[1], twist.angular_radps[2]};
      ++asked_.velocity_number;
      operator_.ask(asked_);
      ++counts_.accepted;
      break;
    case CommandVerdict::kNotFinite:
      ++counts_.not_finite;
      break;
    case CommandVerdict::kAbsurd:
      ++counts_.absurd;
      break;
    case CommandVerdict::kOtherPublisher:
      ++counts_.other_publisher;
      break;
    case CommandVerdict::kObjection:
      // Earlier requests hold no longer either: it need not wait until that is
      // stale.
      if (who == holder_ && (asked_.velocity.vx_mps != 0.0 || asked_.velocity.vy_mps != 0.0 ||
                             asked_.velocity.wz_radps != 0.0)) {
        asked_.velocity = {};
        ++asked_.velocity_number;
        operator_.ask(asked_);
      }
      ++counts_.objected;
      break;
  }
  return verdict;
}

RequestOutcome OperatorDesk::request(std::string_view name, const OperatorId& who,
                                     const Objection& objection) {
  Lock turn(one_by_one_, std::defer_lock);
  std::string objected;
  if (!calms(name)) {
    turn.lock();
    if (objection) objected = objection();
  }
  Lock lock(mutex_);
  const std::string refusal = request_named(name)
                                  ? follow(name, who, objected, lock)
                                  : fmt::format("unknown, expected {}", request_names());
  ++(refusal.empty() ? counts_.requests_accepted : counts_.requests_refused);
  RequestOutcome outcome{refusal.empty(), refusal};
  if (outcome.accepted) outcome.text = fmt::format("mode {}", mode_name(operator_.mode()));
  last_request_ = fmt::format("{}: {}: {}", one_line(std::string(name.substr(0, 15))),
                              outcome.accepted ? "accepted" : "refused", outcome.text);
  return outcome;
}

CommandCounts OperatorDesk::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::string OperatorDesk::last_request() const {
  const std::lock_guard lock(mutex_);
  return last_request_;
}

std::string OperatorDesk::follow(std::string_view name, const OperatorId& who,
                                 const std::string& objected, Lock& lock) {
  // Until the controller has taken a stop or damp, nothing but a damp replaces it.
  while (calming_number_ > operator_.considered() && name != "damp") {
    if (!wait_for(calming_number_, calming_deadline_, lock)) return kNoAnswer;
  }
  const RequestDecision decision = decide(name, operator_.mode(), no_walk_);
  if (decision.refusal) return decision.refusal;
  if (!decision.calms && gate_.held(clock_ns(CLOCK_MONOTONIC)) && who != holder_) {
    return kOtherOperator;
  }
  if (!decision.calms && !objected.empty()) return objected;
  if (decision.calms) {
    asked_.velocity = {};
    ++asked_.velocity_number;
  }
  if (decision.request != ModeRequest::kNone) {
    asked_.request = decision.request;
    ++asked_.request_number;
  }
  operator_.ask(asked_);
  const std::uint64_t number = asked_.request_number;
  const Time deadline = std::chrono::steady_clock::now() + answer_;
  if (decision.calms) {
    calming_number_ = number;
    calming_deadline_ = deadline;
  }
  if (!wait_for(number, deadline, lock)) {
    // An operator who was refused must not see the robot move later; a stop or damp still holds,
    // and so does one that came meanwhile.
    if (!decision.calms && asked_.request_number == number) {
      asked_.request = ModeRequest::kNone;
      ++asked_.request_number;
      operator_.ask(asked_);
    }
    return kNoAnswer;
  }
  if (!decision.calms && asked_.request_number != number) return "a stop or damp came after it";
  const char* const failed = failure(decision.request, operator_.mode());
  const Fault fault = operator_.first_fault();
  if (!failed || fault == Fault::kNone) return failed ? failed : "";
  const char* const remedy = fault_remedy(fault);
  return fmt::format("{}: {}{}{}", failed, fault_name(fault), remedy ? ": " : "",
                     remedy ? remedy : "");
}

bool OperatorDesk::wait_for(std::uint64_t number, Time deadline, Lock& lock) const {
  lock.unlock();
  while (operator_.considered() < number && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kLookEvery);
  }
  lock.lock();
  return operator_.considered() >= number;
}

}  // namespace sandrunner
