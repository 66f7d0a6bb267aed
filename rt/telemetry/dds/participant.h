// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "dds/dds.h"
#include "rt/telemetry/dds/dds_config.h"

namespace sandrunner {

/// Our seat in a DDS domain, and the ways in which we write and read. One for a domain and process.
class DdsParticipant {
 public:
  /// `identity`: whom the security files are for; "robot", "operator", "viewer". What the
  /// environment says of Cyclone DDS does not count. Throws InputError.
  explicit DdsParticipant(const DdsConfig& config, const std::string& identity = "robot");
  ~DdsParticipant();  ///< deletes all writers and readers too
  DdsParticipant(const DdsParticipant&) = delete;
  DdsParticipant& operator=(const DdsParticipant&) = delete;

  /// Reliable writer that keeps the last `depth` values and waits at most 10 ms; `latched`: also
  /// those that come later get the last value. Throws InputError.
  dds_entity_t writer(const char* topic, const dds_topic_descriptor_t& type, int depth,
                      bool latched = false) const;
  /// Reader of the last `depth` values; one that is not `reliable` gets them from any writer.
  /// Throws InputError.
  dds_entity_t reader(const char* topic, const dds_topic_descriptor_t& type, int depth,
                      bool reliable, bool latched = false) const;

  dds_entity_t entity() const noexcept { return participant_; }

 private:
  dds_entity_t topic(const char* name, const dds_topic_descriptor_t& type) const;

  dds_entity_t domain_ = 0, participant_ = 0;
};

/// `result` if it is a handle or success; else throws InputError that names `what`.
dds_entity_t check_dds(dds_entity_t result, const std::string& what);

}  // namespace sandrunner
