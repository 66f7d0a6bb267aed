// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_orders.h"

#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <variant>

namespace sandrunner {
namespace {

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

// `why` empty: it is not.
ViewOrders::Outcome refused(const std::string& why) {
  return {.answer = why.empty() ? "" : view_refusal(why)};
}

}  // namespace

std::string view_state(const ViewServer::Parts& parts) {
  const ViewPace::Status pace = parts.pace ? parts.pace->status() : ViewPace::Status();
  nlohmann::ordered_json json = {{"say", "state"},
                                 {"t_s", parts.feed.now_s()},
                                 {"ended", parts.feed.ended()},
                                 {"paused", pace.paused},
                                 {"rate", pace.rate}};
  if (parts.control) json["ground"] = ground_of(parts.control->ground());
  return dump(json);
}

std::string view_refusal(const std::string& why) {
  return dump({{"say", "refused"}, {"why", why}});
}

ViewOrders::Outcome ViewOrders::follow(const PageMessage& message, bool has_key) {
  if (const auto* nonsense = std::get_if<PageNonsense>(&message)) return refused(nonsense->why);
  if (std::holds_alternative<PageHello>(message)) return refused("hello was said");
  if (!has_key) return refused("without the key this page only looks");
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
  return {.changed = true};
}

ViewOrders::Outcome ViewOrders::drive(const PageDrive& order) {
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

ViewOrders::Outcome ViewOrders::request(const PageRequest& order) {
  if (!parts_.desk) return refused("this run takes no commands from a page");
  const RequestOutcome outcome = parts_.desk->request(order.name, id());
  return {.answer = dump({{"say", "answer"},
                          {"to", order.name},
                          {"accepted", outcome.accepted},
                          {"text", outcome.text}})};
}

// Changes the robot or its ground.
ViewOrders::Outcome ViewOrders::touch(const PageMessage& message) {
  if (!parts_.control) {
    return refused("only a simulated robot in lockstep can be touched, and its ground changed");
  }
  if (const auto* push = std::get_if<PagePush>(&message)) {
    return refused(parts_.control->push(push->direction_rad));
  }
  if (std::holds_alternative<PageSetOnLegs>(message)) {
    return refused(parts_.control->set_on_legs());
  }
  Outcome outcome = refused(parts_.control->set_ground(std::get<PageTerrain>(message).ground));
  outcome.changed = true;
  return outcome;
}

// Among operators: no participant of DDS has an identity that begins with zeros.
OperatorId ViewOrders::id() const {
  OperatorId id{};
  std::memcpy(id.data() + 8, &page_, sizeof page_);
  return id;
}

}  // namespace sandrunner
