// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_messages.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace sandrunner {
namespace {

using Json = nlohmann::json;

// The values of a message's keys; what is amiss, the first of it, ends up in `why`.
class Reader {
 public:
  explicit Reader(const Json& json) : json_(json) {}

  double number(const char* key, double low, double high) {
    const Json* const value = find(key);
    if (!value) return 0.0;
    if (!value->is_number()) return amiss("{}: expected a number", key), 0.0;
    const double x = value->get<double>();
    if (std::isfinite(x) && x >= low && x <= high) return x;
    return amiss("{}: {}, expected {} to {}", key, x, low, high), 0.0;
  }
  int whole(const char* key, int low, int high) {
    const double x = number(key, low, high);
    if (x != std::floor(x)) amiss("{}: {}, expected a whole number", key, x);
    return static_cast<int>(x);
  }
  std::string text(const char* key) {
    const Json* const value = find(key);
    if (!value) return {};
    if (!value->is_string()) return amiss("{}: expected a text", key), std::string();
    return value->get<std::string>();
  }
  bool flag(const char* key) {
    const Json* const value = find(key);
    if (!value) return false;
    if (!value->is_boolean()) return amiss("{}: expected true or false", key), false;
    return value->get<bool>();
  }
  GroundSettings numbers(const char* key) {
    GroundSettings all;
    const Json* const value = find(key);
    if (!value) return all;
    if (!value->is_object()) return amiss("{}: expected an object", key), all;
    for (const auto& [name, number] : value->items()) {
      if (!number.is_number() || !std::isfinite(number.get<double>())) {
        return amiss("{}: expected finite numbers", key), all;
      }
      all.emplace_back(name, number.get<double>());
    }
    return all;
  }
  /// What was read, if all is well and there is nothing else in the message.
  PageMessage all(PageMessage message) {
    if (why_.empty() && json_.size() != found_) amiss("expected {} keys", found_);
    if (!why_.empty()) return PageNonsense{why_};
    return message;
  }

 private:
  const Json* find(const char* key) {
    const auto at = json_.find(key);
    if (at == json_.end()) return amiss("{}: missing", key), nullptr;
    ++found_;
    return &*at;
  }
  template <typename... Values>
  void amiss(fmt::format_string<Values...> text, Values&&... values) {
    if (why_.empty()) why_ = fmt::format(text, std::forward<Values>(values)...);
  }

  const Json& json_;
  std::size_t found_ = 0;
  std::string why_;
};

}  // namespace

PageMessage parse_page_message(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return PageNonsense{"expected a JSON object"};
  Reader in(json);
  const std::string say = in.text("say");
  if (say == "hello") return in.all(PageHello{in.text("key")});
  if (say == "drive") {
    // Absurd velocities are the command gate's to refuse, as it does those from DDS.
    constexpr double kAny = 1e300;
    const double vx = in.number("vx", -kAny, kAny), vy = in.number("vy", -kAny, kAny),
                 wz = in.number("wz", -kAny, kAny);
    return in.all(PageDrive{{vx, vy, wz}});
  }
  if (say == "request") return in.all(PageRequest{in.text("name")});
  if (say == "pace") return in.all(PagePace{in.number("rate", kSlowestPace, kFastestPace)});
  if (say == "pause") return in.all(PagePause{in.flag("on")});
  if (say == "step") {
    return in.all(PageStep{in.whole("ticks", 1, kMostSteps_ticks)});
  }
  if (say == "push") {
    constexpr double kTurn_rad = 2.0 * std::numbers::pi;
    return in.all(PagePush{in.number("direction", -kTurn_rad, kTurn_rad)});
  }
  if (say == "set_on_legs") return in.all(PageSetOnLegs{});
  if (say == "terrain") return in.all(PageTerrain{{in.text("preset"), in.numbers("set")}});
  return PageNonsense{
      "say: expected hello, drive, request, pace, pause, step, push, set_on_legs or terrain"};
}

}  // namespace sandrunner
