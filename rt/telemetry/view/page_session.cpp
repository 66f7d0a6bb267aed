// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/page_session.h"

#include <fmt/format.h>

#include <utility>

#include "rt/telemetry/view/view_rules.h"

namespace sandrunner {
namespace {

constexpr std::chrono::milliseconds kStateEvery{90};  // asked every 16 ms
constexpr std::uint16_t kPolicyError = 1008;

}  // namespace

PageSession::PageSession(const ViewServer::Parts& parts, std::string key, std::string run,
                         std::uint64_t page)
    : parts_(parts), key_(std::move(key)), run_(std::move(run)), orders_(parts, page) {}

std::optional<ViewSession::Goodbye> PageSession::take(std::string_view text) {
  const PageMessage message = parse_page_message(text);
  if (claim_ == Claim::kNone) {
    const auto* const hello = std::get_if<PageHello>(&message);
    if (!hello) return Goodbye{kPolicyError, "expected hello first"};
    greet(*hello);
    return std::nullopt;
  }
  ViewOrders::Outcome outcome = orders_.follow(message, claim_ == Claim::kHasKey);
  if (!outcome.answer.empty()) answers_.push_back(std::move(outcome.answer));
  if (outcome.changed) state_due_ = {};
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
  if (!hello.key.empty() && !has_key) answers_.push_back(view_refusal("the key is not this run's"));
}

ViewSession::Outgoing PageSession::next_data() {
  if (claim_ == Claim::kNone) return {};
  if (std::string rows = parts_.feed.next(in_feed_); !rows.empty()) return {std::move(rows), false};
  const auto now = std::chrono::steady_clock::now();
  if (now < state_due_) return {};
  state_due_ = now + kStateEvery;
  return {view_state(parts_), true};
}

}  // namespace sandrunner
