// SPDX-License-Identifier: BSD-3-Clause
#include "rt/dds/participant.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <net/if.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/errors.h"
#include "rt/base/standard_error.h"

namespace sandrunner {
namespace {

// Any value but the default of 100 ms: a default is not sent on the wire, and some stacks need it
// there.
constexpr dds_duration_t kMaxBlocking = DDS_MSECS(10);

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

Qos make_qos(int depth, bool reliable, bool latched) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kMaxBlocking);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_durability(qos.get(),
                      latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (latched) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

// Cyclone DDS's messages go to standard error. Without its network it would report every packet, so
// there is a limit of lines per ten seconds. While a participant is being created, messages are
// kept: if that fails, they belong into the one line of the error.
constexpr int kLogLines = 20;
constexpr auto kLogTime = std::chrono::seconds(10);

class Log {
 public:
  void keep() {
    const std::lock_guard lock(mutex_);
    keeping_ = true;
    kept_.clear();
  }
  /// The first message since keep().
  std::string stop_keeping() {
    const std::lock_guard lock(mutex_);
    keeping_ = false;
    return kept_;
  }
  void say(std::string_view message) {
    while (message.ends_with('\n')) message.remove_suffix(1);
    const std::lock_guard lock(mutex_);
    if (keeping_) {
      if (kept_.empty()) kept_ = message;
      return;
    }
    const Clock::time_point now = Clock::now();
    if (now - since_ > kLogTime) {
      since_ = now;
      lines_ = 0;
    }
    if (++lines_ > kLogLines) return;
    to_standard_error(fmt::format(
        "DDS: {}\n{}", message,
        lines_ == kLogLines ? "DDS: further messages are not shown for ten seconds\n" : ""));
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  bool keeping_ = false;
  std::string kept_;
  Clock::time_point since_;
  int lines_ = 0;
};

Log& dds_log() {
  static Log log;
  return log;
}

/// Names of this computer's network interfaces.
std::vector<std::string> interfaces() {
  std::vector<std::string> names;
  struct if_nameindex* const all = if_nameindex();
  for (auto* one = all; one && one->if_index != 0; ++one) names.emplace_back(one->if_name);
  if (all) if_freenameindex(all);
  return names;
}

void log_sink(void*, const dds_log_data_t* data) { dds_log().say(data->message); }

}  // namespace

dds_entity_t check_dds(dds_entity_t result, const std::string& what) {
  if (result >= 0) return result;
  throw InputError(
      fmt::format("DDS: {}: found {}, expected success", what, dds_strretcode(result)));
}

DdsParticipant::DdsParticipant(const DdsNetwork& network, const std::string& identity) {
  const std::string where = fmt::format(
      "domain {} on interface {}{}", network.domain, network.interface,
      network.security_dir.empty() ? "" : ", security files of " + network.security_dir);
  const std::string xml = cyclone_xml(network, identity);
  dds_set_log_sink(log_sink, nullptr);
  dds_log().keep();
  domain_ = dds_create_domain(static_cast<dds_domainid_t>(network.domain), xml.c_str());
  // As ROS 2's participants have it: tools then list ours beside those.
  const std::string enclave = "enclave=/;";
  const Qos qos(dds_create_qos());
  dds_qset_userdata(qos.get(), enclave.data(), enclave.size());
  if (domain_ >= 0) {
    participant_ =
        dds_create_participant(static_cast<dds_domainid_t>(network.domain), qos.get(), nullptr);
  }
  const std::string reason = dds_log().stop_keeping();
  const dds_entity_t result = domain_ < 0 ? domain_ : participant_;
  if (result < 0) {
    if (domain_ >= 0) dds_delete(domain_);
    if (reason.find("free participant index") != std::string::npos) {
      throw InputError(fmt::format(
          "DDS: {}: found {} participants or more on this computer, expected a free place: end "
          "some "
          "of them (ROS 2 nodes: `ros2 daemon stop`, fewer processes), or choose another domain: "
          "dds.domain",
          where, kMostParticipants));
    }
    if (reason.find("does not match an available interface") != std::string::npos) {
      throw InputError(fmt::format("DDS: {}: found no such interface, expected one of {}", where,
                                   fmt::join(interfaces(), ", ")));
    }
    check_dds(result, reason.empty() ? where : fmt::format("{} ({})", where, reason));
  }
}

DdsParticipant::~DdsParticipant() {
  dds_delete(participant_);
  dds_delete(domain_);
}

dds_entity_t DdsParticipant::topic(const char* name, const dds_topic_descriptor_t& type) const {
  return check_dds(dds_create_topic(participant_, &type, name, nullptr, nullptr), name);
}

dds_entity_t DdsParticipant::writer(const char* name, const dds_topic_descriptor_t& type, int depth,
                                    bool latched, dds_duration_t lifespan) const {
  const Qos qos = make_qos(depth, true, latched);
  dds_qset_lifespan(qos.get(), lifespan);
  writers_.push_back(
      check_dds(dds_create_writer(participant_, topic(name, type), qos.get(), nullptr), name));
  return writers_.back();
}

dds_entity_t DdsParticipant::reader(const char* name, const dds_topic_descriptor_t& type, int depth,
                                    bool reliable, bool latched) const {
  const Qos qos = make_qos(depth, reliable, latched);
  readers_.push_back(
      check_dds(dds_create_reader(participant_, topic(name, type), qos.get(), nullptr), name));
  return readers_.back();
}

}  // namespace sandrunner
