// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/motion_switcher.h"

#include <nlohmann/json.hpp>

#include "drivers/unitree/unitree_api.h"
#include "rt/base/clock_ns.h"

namespace sandrunner::unitree {
namespace {

constexpr std::int64_t kAgain_ns = 200'000'000;

}  // namespace

std::optional<std::string> mode_name(const std::string& json) {
  const nlohmann::json answer = nlohmann::json::parse(json, nullptr, false);
  if (!answer.is_object()) return std::nullopt;
  const auto name = answer.find("name");
  if (name == answer.end() || !name->is_string()) return std::nullopt;
  return name->get<std::string>();
}

MotionSwitcher::MotionSwitcher(const DdsParticipant& participant)
    : requests_(participant.writer(kSwitcherRequests, unitree_api_msg_dds__Request__desc, 1)),
      responses_(
          participant.reader(kSwitcherResponses, unitree_api_msg_dds__Response__desc, 8, true)) {}

void MotionSwitcher::send(SwitcherRequest request) {
  id_ = clock_ns(CLOCK_MONOTONIC);
  unitree_api_msg_dds__Request_ message{};
  message.header.identity.id = id_;
  message.header.identity.api_id = static_cast<std::int64_t>(request);
  std::string parameter = "{}";
  message.parameter = parameter.data();
  dds_write(requests_, &message);  // whether it arrives, the answer tells
}

std::optional<MotionSwitcher::Answer> MotionSwitcher::take() {
  std::optional<Answer> answer;
  sandrunner::take(responses_, [&](const void* data, const dds_sample_info_t&) {
    const auto& response = *static_cast<const unitree_api_msg_dds__Response_*>(data);
    if (response.header.identity.id != id_) return;  // to another program, or to an earlier request
    answer = Answer{.code = response.header.status.code,
                    .data = response.data != nullptr ? response.data : ""};
  });
  return answer;
}

std::optional<MotionSwitcher::Answer> MotionSwitcher::ask(SwitcherRequest request, double timeout_s,
                                                          const std::function<void()>& pause) {
  const std::int64_t start_ns = clock_ns(CLOCK_MONOTONIC);
  const auto timeout_ns = static_cast<std::int64_t>(1e9 * timeout_s);
  std::int64_t sent_ns = 0;
  for (std::int64_t now_ns = start_ns; now_ns - start_ns < timeout_ns;
       now_ns = clock_ns(CLOCK_MONOTONIC)) {
    if (now_ns - sent_ns >= kAgain_ns) {
      send(request);
      sent_ns = now_ns;
    }
    pause();
    if (std::optional<Answer> answer = take()) return answer;
  }
  return std::nullopt;
}

}  // namespace sandrunner::unitree
