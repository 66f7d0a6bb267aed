// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/foxglove_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace sandrunner {
namespace {

using Json = nlohmann::json;

// First bytes of binary messages.
constexpr char kMessageData = 1, kTime = 2;
constexpr std::uint64_t kTimeEvery_ns = 50'000'000;  // while no message says it

template <typename T>
void append(std::string& bytes, T number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string advertisement() {
  Json channels = Json::array();
  for (std::size_t i = 0; i < kNumRunTopics; ++i) {
    if (i == index_of(RunTopic::kStates)) continue;
    const RunTopicInfo& topic = run_topics()[i];
    channels.push_back({{"id", i},
                        {"topic", topic.name},
                        {"encoding", "cdr"},
                        {"schemaName", topic.schema},
                        {"schema", topic.schema_text},
                        {"schemaEncoding", topic.schema_encoding}});
  }
  return Json{{"op", "advertise"}, {"channels", channels}}.dump();
}

std::string warning(const std::string& what) {
  return Json{{"op", "status"}, {"level", 1}, {"message", what}}.dump();
}

// Null: it is no object, or has no such key.
const Json* member_of(const Json& json, const char* key) {
  if (!json.is_object()) return nullptr;
  const auto found = json.find(key);
  return found == json.end() ? nullptr : &*found;
}

// Empty: it is none.
std::string text_of(const Json* json) {
  return json && json->is_string() ? json->get<std::string>() : std::string();
}

std::optional<std::uint32_t> id_of(const Json* json) {
  if (!json || !json->is_number_unsigned()) return std::nullopt;
  const auto id = json->get<std::uint64_t>();
  if (id > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(id);
}

}  // namespace

FoxgloveSession::FoxgloveSession(LiveTopics& topics, const std::string& run)
    : topics_(topics), place_(topics.join()) {
  answers_.push_back(Json{
      {"op", "serverInfo"},
      {"name", "sandrunner"},
      {"capabilities", {"time"}},
      {"sessionId", run}}.dump());
  answers_.push_back(advertisement());
}

FoxgloveSession::~FoxgloveSession() {
  for (std::size_t i = 0; i < kNumRunTopics; ++i) {
    if (ids_[i]) topics_.unsubscribe(static_cast<RunTopic>(i));
  }
}

std::optional<ViewSession::Goodbye> FoxgloveSession::take(std::string_view text) {
  // Values are looked at where they are: a copy of deeply nested ones would need as deep a stack.
  const Json json = Json::parse(text, nullptr, false);
  const std::string op = text_of(member_of(json, "op"));
  std::string wrong;
  const auto each = [&](const char* key, auto&& follow) {
    const Json* const list = member_of(json, key);
    if (!list || !list->is_array()) {
      wrong = fmt::format("{}: expected an array", key);
      return;
    }
    for (const Json& item : *list) {
      if (const std::string amiss = follow(item); wrong.empty()) wrong = amiss;
    }
  };
  if (op == "subscribe") {
    each("subscriptions", [this](const Json& wish) { return subscribe(wish); });
  } else if (op == "unsubscribe") {
    each("subscriptionIds", [this](const Json& id) { return unsubscribe(id); });
  } else {
    wrong = "op: expected subscribe or unsubscribe: this server only shows";
  }
  if (!wrong.empty()) answers_.push_back(warning(wrong));
  return std::nullopt;
}

std::string FoxgloveSession::subscribe(const nlohmann::json& wish) {
  const std::optional<Id> id = id_of(member_of(wish, "id"));
  const std::optional<Id> channel = id_of(member_of(wish, "channelId"));
  if (!id || !channel) return "subscriptions: expected numbers id and channelId in each";
  if (*channel >= kNumRunTopics || *channel == index_of(RunTopic::kStates)) {
    return fmt::format("channelId: {} was not advertised", *channel);
  }
  if (std::ranges::find(ids_, id) != ids_.end()) return fmt::format("id: {} is in use", *id);
  if (ids_[*channel]) return fmt::format("channelId: {} has a subscription", *channel);
  ids_[*channel] = id;
  subscribed_.set(*channel);
  if (run_topics()[*channel].once) owed_.set(*channel);
  topics_.subscribe(static_cast<RunTopic>(*channel));
  return {};
}

std::string FoxgloveSession::unsubscribe(const nlohmann::json& json) {
  const std::optional<Id> id = id_of(&json);
  const auto found = id ? std::ranges::find(ids_, id) : ids_.end();
  if (found == ids_.end()) return "subscriptionIds: expected numbers of subscriptions";
  const auto channel = static_cast<std::size_t>(found - ids_.begin());
  const auto topic = static_cast<RunTopic>(channel);
  found->reset();
  subscribed_.reset(channel);
  owed_.reset(channel);
  if (held_ && held_->topic == topic) held_.reset();
  topics_.unsubscribe(topic);
  return {};
}

std::shared_ptr<const LiveTopics::Message> FoxgloveSession::next_message() {
  for (std::size_t i = 0; i < kNumRunTopics; ++i) {
    if (!owed_[i]) continue;
    if (auto message = topics_.said_once(static_cast<RunTopic>(i))) {
      owed_.reset(i);
      return message;
    }
  }
  return topics_.next(place_, subscribed_);
}

ViewSession::Outgoing FoxgloveSession::next_data() {
  if (!held_) held_ = next_message();
  std::string bytes;
  // Time first: the client takes a message for one of the time that was said last.
  const std::uint64_t now_ns = held_ ? held_->time_ns : topics_.time_ns();
  if (now_ns > said_ns_ + (held_ ? 0 : kTimeEvery_ns)) {
    said_ns_ = now_ns;
    bytes += kTime;
    append(bytes, now_ns);
  } else if (held_) {
    bytes += kMessageData;
    append(bytes, *ids_[index_of(held_->topic)]);
    append(bytes, held_->time_ns);
    bytes += held_->cdr;
    held_.reset();
  }
  return {std::move(bytes), false};
}

}  // namespace sandrunner
