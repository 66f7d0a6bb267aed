// SPDX-License-Identifier: BSD-3-Clause
// Anything that a visitor may send to the server of --view: as a message of a page or of Foxglove,
// and as the lines of a request.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <variant>

#include "rt/telemetry/view/foxglove_session.h"
#include "rt/telemetry/view/view_messages.h"
#include "rt/telemetry/view/view_rules.h"

namespace sandrunner {
namespace {

void must(bool holds) {
  if (!holds) std::abort();
}

/// What was understood is within its bounds, whatever it was made of.
struct WithinBounds {
  void operator()(const PageNonsense& m) const { must(!m.why.empty()); }
  void operator()(const PageHello&) const {}
  void operator()(const PageRequest&) const {}
  void operator()(const PagePause&) const {}
  void operator()(const PageSetOnLegs&) const {}
  void operator()(const PageDrive& m) const {
    must(std::isfinite(m.velocity.vx_mps) && std::isfinite(m.velocity.vy_mps) &&
         std::isfinite(m.velocity.wz_radps));
  }
  void operator()(const PagePace& m) const {
    must(m.rate >= kSlowestPace && m.rate <= kFastestPace);
  }
  void operator()(const PageStep& m) const { must(m.ticks >= 1 && m.ticks <= kMostSteps_ticks); }
  void operator()(const PagePush& m) const { must(std::abs(m.direction_rad) < 6.3); }
  void operator()(const PageTerrain& m) const {
    for (const auto& [key, value] : m.ground.set) must(std::isfinite(value));
  }
};

void judge_lines(std::string_view text) {
  std::array<std::string_view, 4> lines;
  for (std::string_view& line : lines) {
    const std::size_t end = text.find('\n');
    line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  const auto [target, host, origin, method] = lines;
  for (const bool websocket : {false, true}) {
    for (const std::string_view by : {std::string_view("GET"), method}) {
      const ViewVerdict verdict = judge({by, target, host, origin, websocket, method, true});
      const bool good = verdict.status == 200 || verdict.status == 101;
      must(good || verdict.status == 403 || verdict.status == 404 || verdict.status == 405);
      must(good == verdict.reason.empty());
      if (!good) continue;
      must(by == "GET" && websocket == (verdict.status == 101) && !host.empty());
      must(host.find_first_of("/@ ") == std::string_view::npos);
      if (websocket && verdict.protocol.empty()) {
        must(origin.starts_with("http://") && origin.substr(7) == host);
      }
      if (!websocket) must(!verdict.file.empty() && !verdict.type.empty());
      if (verdict.protocol.empty()) continue;
      must(websocket && method.find(verdict.protocol) != std::string_view::npos);
      must(origin.empty() || origin == "file://" || origin == "https://app.foxglove.dev" ||
           origin.starts_with("http://127.0.0.1") || origin.starts_with("http://localhost") ||
           origin.starts_with("http://[::1]"));
    }
  }
  must(same_key(target, host) == (target == host));
}

/// Each line said to a session of Foxglove, while a robot walks.
void tell_foxglove(std::string_view text) {
  LiveTopics topics{RobotDescription()};
  topics.begin(0);
  FoxgloveSession session(topics, "run");
  TickRecord tick{};
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    must(!session.take(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
    topics.add(tick);
    tick.input.sensors.tick += kTicksPerPolicyStep;
    for (;;) {
      const ViewSession::Outgoing out = session.next();
      if (out.bytes.empty()) break;
      must(out.text ? out.bytes.front() == '{' : out.bytes.front() == 1 || out.bytes.front() == 2);
    }
    must(session.listens());
  }
}

}  // namespace
}  // namespace sandrunner

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::visit(sandrunner::WithinBounds(), sandrunner::parse_page_message(text));
  sandrunner::judge_lines(text);
  sandrunner::tell_foxglove(text);
  return 0;
}
