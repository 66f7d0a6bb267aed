// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dds/dds.h"
#include "rt/dds/network.h"

namespace sandrunner {

/// This process as a member of a DDS domain, and the ways in which it writes and reads. One per
/// domain and process.
class DdsParticipant {
 public:
  /// `identity`: whose security files are used: "robot", "operator" or "viewer". Settings of
  /// Cyclone DDS in the environment are ignored. Throws InputError.
  explicit DdsParticipant(const DdsNetwork& network, const std::string& identity = "robot");
  ~DdsParticipant();  ///< deletes all writers and readers too
  DdsParticipant(const DdsParticipant&) = delete;
  DdsParticipant& operator=(const DdsParticipant&) = delete;

  /// Reliable writer that keeps the last `depth` values and waits at most 10 ms; `latched`: readers
  /// that come later get the last values too; a value that has not arrived within `lifespan` is not
  /// sent again. Throws InputError.
  dds_entity_t writer(const char* topic, const dds_topic_descriptor_t& type, int depth,
                      bool latched = false, dds_duration_t lifespan = DDS_INFINITY) const;
  /// Reader of the last `depth` values; if not `reliable`, it also matches writers that are not.
  /// Throws InputError.
  dds_entity_t reader(const char* topic, const dds_topic_descriptor_t& type, int depth,
                      bool reliable, bool latched = false) const;

  dds_entity_t entity() const noexcept { return participant_; }
  /// Made so far.
  const std::vector<dds_entity_t>& writers() const noexcept { return writers_; }
  const std::vector<dds_entity_t>& readers() const noexcept { return readers_; }

 private:
  dds_entity_t topic(const char* name, const dds_topic_descriptor_t& type) const;

  dds_entity_t domain_ = 0, participant_ = 0;
  mutable std::vector<dds_entity_t> writers_, readers_;
};

/// Takes the messages that have arrived, `limit` at most; `use` is given each as
/// (const void* message, const dds_sample_info_t& info). Returns how many there were.
template <typename Use>
long long take(dds_entity_t reader, const Use& use, long long limit = INT64_MAX) {
  long long taken = 0;
  void* message = nullptr;
  dds_sample_info_t info;
  while (taken < limit && dds_take(reader, &message, &info, 1, 1) == 1) {
    if (info.valid_data) {
      use(static_cast<const void*>(message), info);
      ++taken;
    }
    dds_return_loan(reader, &message, 1);
    message = nullptr;
  }
  return taken;
}

/// `result` if it is a handle or a success; otherwise throws an InputError that names `what`.
dds_entity_t check_dds(dds_entity_t result, const std::string& what);

}  // namespace sandrunner
