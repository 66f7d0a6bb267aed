// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/page_session.h"

#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "rt/telemetry/view/view_rules.h"

namespace sandrunner {
namespace {

constexpr std::chrono::milliseconds kStateEvery{90};  // asked every 16 ms
constexpr std::uint16_t kPolicyError = 1008;

std::string dump(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

nlohmann::ordered_json ground_of(const GroundNow& ground) {
  const auto object = [](const GroundSettings& values) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [key, value] : values) json[key] = value;
    return json;
  };
  return {{"preset", ground.wanted.preset},
          {"set", object(ground.wanted.set)},
          {"name", ground.name},
          {"kind", ground.kind},
          {"granular", ground.granular},
          {"presets", ground.presets},
          {"values", object(ground.values)}};
}

// What changes while a run goes on.
std::string state(const ViewServer::Parts& parts) {
  const ViewPace::Status pace = parts.pace ? parts.pace->status() : ViewPace::Status();
  nlohmann::ordered_json json = {{"say", "state"},
                                 {"t_s", parts.feed.now_s()},
                                 {"ended", parts.feed.ended()},
                                 {"paused", pace.paused},
                                 {"rate", pace.rate}};
  if (parts.control) json["ground"] = ground_of(parts.control->ground());
  return dump(json);
}

// JSON that says why; "" if `why` is empty.
std::string refused(const std::string& why) {
  return why.empty() ? "" : dump({{"say", "refused"}, {"why", why}});
}

}  // namespace

PageSession::PageSession(const ViewServer::Parts& parts, std::string key, std::string run,
                         std::uint64_t page)
    : parts_(parts), key_(std::move(key)), run_(std::move(run)), page_(page) {}

std::optional<ViewSession::Goodbye> PageSession::take(std::string_view text) {
  const PageMessage message = parse_page_message(text);
  if (claim_ == Claim::kNone) {
    const auto* const hello = std::get_if<PageHello>(&message);
    if (!hello) return Goodbye{kPolicyError, "expected hello first"};
    greet(*hello);
    return std::nullopt;
  }
  if (std::string answer = follow(message); !answer.empty()) answers_.push_back(std::move(answer));
  return std::nullopt;
}

void PageSession::greet(const PageHello& hello) {
  const bool has_key = same_key(hello.key, key_);
  claim_ = has_key ? Claim::kHasKey : Claim::kLooks;
  in_feed_ = parts_.feed.join();
  answers_.push_back(fmt::format(
      R"({{"say":"hello","run":"{}","key":{},"pace":{},"drive":{},"recorded":{},"hello":{}}})",
      run_, has_key, parts_.pace != nullptr, parts_.desk != nullptr, parts_.recorded,
      parts_.feed.hello()));
  if (!hello.key.empty() && !has_key) answers_.push_back(refused("the key is not this run's"));
}

std::string PageSession::follow(const PageMessage& message) {
  if (const auto* nonsense = std::get_if<PageNonsense>(&message)) return refused(nonsense->why);
  if (std::holds_alternative<PageHello>(message)) return refused("hello was said");
  if (claim_ != Claim::kHasKey) return refused("without the key this page only looks");
  if (const auto* order = std::get_if<PageDrive>(&message)) return drive(*order);
  if (const auto* order = std::get_if<PageRequest>(&message)) return request(*order);
  if (std::holds_alternative<PagePush>(message) || std::holds_alternative<PageSetOnLegs>(message) ||
      std::holds_alternative<PageTerrain>(message)) {
    return touch(message);
  }
  if (!parts_.pace) return refused("this robot has its own time");
  if (const auto* order = std::get_if<PagePace>(&message)) parts_.pace->set_rate(order->rate);
  if (const auto* order = std::get_if<PagePause>(&message)) parts_.pace->pause(order->on);
  if (const auto* order = std::get_if<PageStep>(&message)) parts_.pace->step(order->ticks);
  state_due_ = {};
  return {};
}

std::string PageSession::drive(const PageDrive& order) {
  if (!parts_.desk) return refused("this run takes no commands from a page");
  const auto& [vx_mps, vy_mps, wz_radps] = order.velocity;
  // No publisher of DDS has a number of all ones.
  const Twist twist{.linear_mps = {vx_mps, vy_mps, 0.0}, .angular_radps = {0.0, 0.0, wz_radps}};
  switch (parts_.desk->drive(twist, ~page_, id())) {
    case CommandVerdict::kAccepted:
      return {};
    case CommandVerdict::kOtherPublisher:
      return refused(kOtherOperator);
    case CommandVerdict::kNotFinite:
    case CommandVerdict::kAbsurd:
    case CommandVerdict::kObjection:  // a page speaks to one robot: nothing is objected
      break;
  }
  return refused(
      fmt::format("a velocity of {}, {} m/s, {} rad/s is absurd", vx_mps, vy_mps, wz_radps));
}

std::string PageSession::request(const PageRequest& order) {
  if (!parts_.desk) return refused("this run takes no commands from a page");
  const RequestOutcome outcome = parts_.desk->request(order.name, id());
  return dump({{"say", "answer"},
               {"to", order.name},
               {"accepted", outcome.accepted},
               {"text", outcome.text}});
}

// Changes the robot or its ground.
std::string PageSession::touch(const PageMessage& message) {
  if (!parts_.control) {
    return refused("only a simulated robot in lockstep can be touched, and its ground changed");
  }
  if (const auto* push = std::get_if<PagePush>(&message)) {
    return refused(parts_.control->push(push->direction_rad));
  }
  if (std::holds_alternative<PageSetOnLegs>(message)) {
    return refused(parts_.control->set_on_legs());
  }
  state_due_ = {};
  return refused(parts_.control->set_ground(std::get<PageTerrain>(message).ground));
}

// Among operators: no participant of DDS has an identity that begins with zeros.
OperatorId PageSession::id() const {
  OperatorId id{};
  std::memcpy(id.data() + 8, &page_, sizeof page_);
  return id;
}

ViewSession::Outgoing PageSession::next_data() {
  if (claim_ == Claim::kNone) return {};
  if (std::string rows = parts_.feed.next(in_feed_); !rows.empty()) return {std::move(rows), false};
  const auto now = std::chrono::steady_clock::now();
  if (now < state_due_) return {};
  state_due_ = now + kStateEvery;
  return {state(parts_), true};
}

}  // namespace sandrunner
