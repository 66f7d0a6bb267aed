// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer on the decoders of moteus' frames: any frame is refused, or read in few steps as values
// that a drive may be given.
#include <cmath>

#include "drivers/drives/moteus/moteus.h"
#include "tests/drivers/fuzz/fuzz_frame.h"

namespace sandrunner {
namespace {

void check(const MoteusDrive& drive, const CanFrame& frame) {
  MoteusReader reader(frame);
  MoteusItem item;
  int items = 0;
  while (reader.next(item)) require(++items <= kMaxFdBytes * kMaxFdBytes);

  MoteusReply reply;
  if (decode_moteus_reply(drive, frame, reply) == MoteusStatus::kOk) {
    require(static_cast<int>(reply.mode) < kNumMoteusModes);
    require(std::isfinite(reply.position_rad) && std::isfinite(reply.velocity_radps) &&
            std::isfinite(reply.torque_nm));
    (void)moteus_fault_words(reply.code);
  }

  MoteusRequest request;
  if (decode_moteus_request(drive, frame, request) == MoteusStatus::kOk) {
    require(request.num_reads >= 0 && request.num_reads <= MoteusRequest::kMaxReads);
    CanFrame answer;
    if (encode_moteus_reply(drive, request, reply, answer) == MoteusStatus::kOk) {
      require(is_sendable(answer));
      MoteusReader written(answer);
      while (written.next(item)) require(item.operation != MoteusOperation::kWrite);
      require(written.status() == MoteusStatus::kOk);
    }
  }
}

}  // namespace
}  // namespace sandrunner

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandrunner;  // NOLINT(google-build-using-namespace)
  if (size < 1) return 0;
  MoteusDrive drive;
  drive.kp_nmprev = drive.kd_nmsprev = 1.0;
  check(drive, fuzz_frame(data + 1, size - 1, data[0] % 2 == 0 ? 0x100 : 0x8001));
  return 0;
}
