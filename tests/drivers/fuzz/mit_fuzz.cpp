// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer on the decoders of the MIT layout and of Damiao's registers: any frame is refused, or
// read as values that are within the limits and that are sent as the same bytes again.
#include <algorithm>
#include <cmath>

#include "drivers/drives/mit/damiao_registers.h"
#include "drivers/drives/mit/mit.h"
#include "tests/drivers/fuzz/fuzz_frame.h"

namespace sandrunner {
namespace {

bool same_data(const CanFrame& a, const CanFrame& b) {
  return a.length == b.length &&
         std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin());
}

void check(const MitDrive& drive, const CanFrame& frame) {
  CanFrame again;
  MitReply reply;
  const MitStatus status = decode_mit_reply(drive, frame, reply);
  if (status == MitStatus::kOk) {
    require(std::fabs(reply.position_rad) <= drive.limits.position_rad);
    require(std::fabs(reply.velocity_radps) <= drive.limits.velocity_radps);
    require(std::fabs(reply.torque_nm) <= drive.limits.reply_torque_nm);
    require(encode_mit_reply(drive, reply, again) == MitStatus::kOk && same_data(frame, again));
  }
  (void)mit_fault_words(drive.variant, reply.fault);

  MitRequest request;
  if (decode_mit_request(drive, frame, request) == MitStatus::kOk) {
    if (request.is_special) {
      require(encode_mit_special(drive, request.special, again) == MitStatus::kOk);
      require(same_data(frame, again));
    } else {
      require(encode_mit_command(drive, request.command, again) == MitStatus::kOk);
      const bool is_highest = (frame.data[6] & 0xF) == 0xF && frame.data[7] > 0xFA;
      require(is_highest || same_data(frame, again));
      require(decode_mit_request(drive, again, request) == MitStatus::kOk && !request.is_special);
    }
  }
  DamiaoAccess access;
  if (decode_damiao_reply(drive, frame, access) == DamiaoStatus::kOk) {
    require(encode_damiao_reply(drive, access, again) == DamiaoStatus::kOk);
    require(same_data(frame, again));
  }
  if (decode_damiao_request(drive, frame, access) == DamiaoStatus::kOk) {
    require(std::isfinite(access.value));
  }
}

}  // namespace
}  // namespace sandrunner

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandrunner;  // NOLINT(google-build-using-namespace)
  if (size < 1) return 0;
  MitDrive drive;
  drive.motor_id = 3;
  drive.reply_id = 0x10;
  drive.variant = static_cast<MitVariant>(data[0] & 3);
  drive.format = (data[0] & 4) != 0 ? CanFormat::kFdWithBitRateSwitch : CanFormat::kClassic;
  drive.limits.velocity_radps = 45.0;
  drive.limits.torque_nm = 18.0;
  drive.limits.reply_torque_nm = 21.0;
  const std::uint32_t ids[] = {drive.motor_id, drive.reply_id, kDamiaoRegisterId, 0};
  check(drive, fuzz_frame(data + 1, size - 1, ids[data[0] >> 3 & 3]));
  return 0;
}
