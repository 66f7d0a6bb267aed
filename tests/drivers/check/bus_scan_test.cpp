// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/bus_scan.h"

#include <gtest/gtest.h>

#include "tests/drivers/robot/example.h"

namespace sandrunner {
namespace {

MitReply cool() {
  MitReply reply;
  reply.temperature_degc = reply.rotor_temperature_degc = 30.0;
  reply.power = MitPower::kEnabled;
  return reply;
}

TEST(BusScanTest, SpeaksToEveryIdWithoutPowerAndKnowsItsReply) {
  const HardwareConfig mit = example_hardware("mit");
  for (int id = 1; id <= kMostScannedId; ++id) {
    DriveConfig drive = mit.drives[0];
    mit_of(drive).motor_id = static_cast<std::uint16_t>(id);
    MitRequest request;
    ASSERT_EQ(decode_mit_request(mit_of(drive), scan_frame(mit.buses[0], id), request),
              MitStatus::kOk);
    EXPECT_TRUE(request.is_special && request.special == MitSpecial::kDisable);
    CanFrame reply;
    ASSERT_EQ(encode_mit_reply(mit_of(drive), cool(), reply), MitStatus::kOk);
    EXPECT_TRUE(is_scan_reply(mit, 0, id, reply));
    EXPECT_FALSE(is_scan_reply(mit, 0, id + 1, reply));
  }
}

TEST(BusScanTest, ADamiaosStateDoesNotHideItsId) {
  HardwareConfig config = example_hardware("mit");
  MitDrive& drive = mit_of(config.drives[0]);
  drive.variant = MitVariant::kDamiao;
  drive.motor_id = 3;
  CanFrame reply;
  ASSERT_EQ(encode_mit_reply(drive, cool(), reply), MitStatus::kOk);
  EXPECT_TRUE(is_scan_reply(config, 0, 3, reply));
  EXPECT_FALSE(is_scan_reply(config, 0, 4, reply));
}

TEST(BusScanTest, MoteusAreAskedAndLeftAsTheyAre) {
  const HardwareConfig config = example_hardware("moteus");
  MoteusDrive drive = moteus_of(config.drives[0]);
  drive.id = 9;
  MoteusRequest request;
  ASSERT_EQ(decode_moteus_request(drive, scan_frame(config.buses[0], 9), request),
            MoteusStatus::kOk);
  EXPECT_FALSE(request.has_mode);
  MoteusReply state;
  state.position_rad = state.velocity_radps = state.torque_nm = 0.0;
  CanFrame reply;
  ASSERT_EQ(encode_moteus_reply(drive, request, state, reply), MoteusStatus::kOk);
  EXPECT_TRUE(is_scan_reply(config, 0, 9, reply));
  EXPECT_FALSE(is_scan_reply(config, 0, 8, reply));
}

}  // namespace
}  // namespace sandrunner
