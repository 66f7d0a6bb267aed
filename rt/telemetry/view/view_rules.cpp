// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_rules.h"

#include <algorithm>
#include <random>

namespace sandrunner {
namespace {

constexpr std::string_view kHere[] = {"127.0.0.1", "localhost", "[::1]"};

bool is_port(std::string_view text) noexcept {
  return !text.empty() && text.size() <= 5 &&
         std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_this_computer(std::string_view host) noexcept {
  return std::ranges::any_of(kHere, [&](std::string_view name) {
    if (!host.starts_with(name)) return false;
    const std::string_view rest = host.substr(name.size());
    return rest.empty() || (rest.front() == ':' && is_port(rest.substr(1)));
  });
}

// The same bytes under both names.
constexpr std::string_view kFoxglove[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

// Of a list with commas.
bool offers(std::string_view list, std::string_view name) noexcept {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view item = list.substr(0, comma);
    while (item.starts_with(' ')) item.remove_prefix(1);
    while (item.ends_with(' ')) item.remove_suffix(1);
    if (item == name) return true;
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return false;
}

constexpr std::string_view kHttp = "http://";

ViewVerdict judge_foxglove(const ViewRequest& request) noexcept {
  const std::string_view origin = request.origin;
  const bool here = origin.starts_with(kHttp) && is_this_computer(origin.substr(kHttp.size()));
  if (!here && !origin.empty() && origin != "file://" && origin != "https://app.foxglove.dev") {
    return {.status = 403, .reason = "Origin is not Foxglove\n"};
  }
  for (const std::string_view name : kFoxglove) {
    if (offers(request.protocols, name)) return {.status = 101, .protocol = name};
  }
  return {.status = 404, .reason = "no such protocol\n"};
}

}  // namespace

ViewVerdict judge(const ViewRequest& request) noexcept {
  if (!is_this_computer(request.host)) {
    return {.status = 403, .reason = "Host is not this computer\n"};
  }
  if (request.method != "GET") return {.status = 405, .reason = "only GET\n"};
  if (request.websocket) {
    if (request.target == "/" && request.topics) return judge_foxglove(request);
    if (request.target != "/live") return {.status = 404, .reason = "no such name\n"};
    const bool own =
        request.origin.starts_with(kHttp) && request.origin.substr(kHttp.size()) == request.host;
    if (!own) return {.status = 403, .reason = "Origin is not this server\n"};
    return {.status = 101};
  }
  if (request.target == "/") {
    return {.status = 200, .file = "page.html", .type = "text/html; charset=utf-8"};
  }
  if (request.target == "/page.css") {
    return {.status = 200, .file = "page.css", .type = "text/css; charset=utf-8"};
  }
  if (request.target == "/page.js") {
    return {.status = 200, .file = "page.js.gz", .type = "text/javascript; charset=utf-8"};
  }
  return {.status = 404, .reason = "no such name\n"};
}

std::string make_view_key() {
  std::random_device random;  // the kernel's or the processor's, not a generator with a seed
  std::string key;
  for (int i = 0; i < 4; ++i) {
    std::uint32_t bits = random();
    for (int digit = 0; digit < 8; ++digit, bits >>= 4) key += "0123456789abcdef"[bits & 15];
  }
  return key;
}

bool same_key(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

bool MessageRate::allows(Time now) noexcept {
  if (count_ == 0 || now - second_ >= std::chrono::seconds(1)) {
    second_ = now;
    count_ = 0;
  }
  return ++count_ <= kViewMessagesPerSecond;
}

}  // namespace sandrunner
