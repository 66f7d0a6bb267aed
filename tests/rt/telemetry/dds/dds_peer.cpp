// SPDX-License-Identifier: BSD-3-Clause
// Cyclone DDS in another process, for tests:
//   dds_peer DOMAIN INTERFACE drive VX_MPS COUNT [SECURITY_DIR IDENTITY]   Twists at 50 Hz
//   dds_peer DOMAIN INTERFACE watch SECONDS [SECURITY_DIR IDENTITY]        counts the gaps between
//       batches of ticks, and the ticks that are neither there nor reported as missed by the robot
//   dds_peer DOMAIN XML stock SECONDS      what comes on rt/odom with this configuration of Cyclone
//       DDS
// Prints what it did as one line; "matched" as soon as it has found the other end, and "watching"
// before that, when its reader is there.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <thread>

#include "rt/dds/participant.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/sandrunner.h"
#include "tests/rt/telemetry/dds/support.h"

namespace sandrunner {
namespace {

using Steady = std::chrono::steady_clock;

void say(const char* line) {
  std::puts(line);
  std::fflush(stdout);
}

int drive(const DdsParticipant& participant, double vx_mps, int count) {
  const dds_entity_t writer =
      participant.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc, 1);
  for (int i = 0; i < 150; ++i) {
    dds_publication_matched_status_t status;
    dds_get_publication_matched_status(writer, &status);
    if (status.current_count > 0) {
      say("matched");
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  geometry_msgs_msg_dds__Twist_ twist{};
  twist.linear.x = vx_mps;
  for (int i = 0; i < count; ++i) {
    dds_write(writer, &twist);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::printf("sent %d\n", count);
  return 0;
}

int watch(const DdsParticipant& participant, double duration_s) {
  const dds_entity_t reader =
      participant.reader("sandrunner/ticks", sandrunner_TickBatch_desc, 1000, true);
  say("watching");
  long batches = 0, gaps = 0, ticks = 0;
  std::uint64_t last = 0, next_tick = 0, lost = 0;
  const auto end = Steady::now() + std::chrono::duration<double>(duration_s);
  while (Steady::now() < end) {
    take<sandrunner_TickBatch>(reader, [&](const sandrunner_TickBatch& batch) {
      if (batches == 0) say("matched");
      if (batches != 0 && batch.sequence_number != last + 1) ++gaps;
      last = batch.sequence_number;
      for (std::uint32_t i = 0; i < batch.ticks._length; ++i) {
        const sandrunner_TickState& tick = batch.ticks._buffer[i];
        if (batches != 0 || i != 0) lost += tick.tick - tick.skipped - next_tick;
        next_tick = tick.tick + 1;
      }
      ++batches;
      ticks += batch.ticks._length;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::printf("batches %ld gaps %ld ticks %ld lost_ticks %lld last %llu\n", batches, gaps, ticks,
              static_cast<long long>(lost), static_cast<unsigned long long>(last));
  return 0;
}

int stock(int domain, const char* xml, double duration_s) {
  DdsConfig config;
  config.domain = domain;
  check_dds(dds_create_domain(static_cast<dds_domainid_t>(domain), xml), "domain");
  Peer peer(config);
  const dds_entity_t reader = peer.reader("rt/odom", nav_msgs_msg_dds__Odometry__desc);
  long long count = 0;
  const auto end = Steady::now() + std::chrono::duration<double>(duration_s);
  while (Steady::now() < end) {
    count += take<nav_msgs_msg_dds__Odometry_>(reader, [](const auto&) {});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("odom %lld\n", count);
  return 0;
}

int run(int argc, char** argv) {
  if (argc < 5) return 2;
  const std::string what = argv[3];
  if (what == "stock") return stock(std::atoi(argv[1]), argv[2], std::atof(argv[4]));
  const int own = what == "drive" ? 6 : 5;
  DdsConfig config;
  config.domain = std::atoi(argv[1]);
  config.interface = argv[2];
  std::string identity;
  if (argc == own + 2) {
    config.security_dir = argv[own];
    identity = argv[own + 1];
  } else if (argc != own) {
    return 2;
  }
  const DdsParticipant participant(config, identity);
  if (what == "drive") return drive(participant, std::atof(argv[4]), std::atoi(argv[5]));
  return what == "watch" ? watch(participant, std::atof(argv[4])) : 2;
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  try {
    return sandrunner::run(argc, argv);
  } catch (const std::exception& e) {
    std::printf("refused: %s\n", e.what());
    return 1;
  }
}
