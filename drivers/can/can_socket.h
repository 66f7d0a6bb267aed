// SPDX-License-Identifier: BSD-3-Clause
// One CAN bus as Linux offers it: a raw SocketCAN socket that never waits.
//
// Source: Linux, Documentation/networking/can.rst and timestamping.rst.
//
// The interface itself (bit rates, queue length, restart after bus-off) is set up outside, with
// `ip link`. Its send queue must be no longer than a cycle's frames: what waits in it is stale.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "drivers/can/can_frame.h"

namespace sandrunner {

/// Frames whose identifier equals `id` in the bits of `mask` are received, others are not.
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = kMaxExtendedId;
  bool extended = false;  ///< 29-bit identifiers only, else 11-bit ones only
};

struct CanSocketConfig {
  std::string interface;               ///< such as can0
  bool fd = false;                     ///< CAN FD frames too
  std::span<const CanFilter> filters;  ///< empty: nothing but error frames
  /// Frames sent here are heard by other sockets on this computer (candump). vcan has no other way
  /// to anybody; on a real bus it costs time for each frame.
  bool loopback = true;
  /// Of the kernel's receive buffer; 0: its default, about 270 frames. Counts for bursts only:
  /// a program that receives in each cycle leaves it empty.
  int receive_buffer_bytes = 0;
};

/// A frame and when the kernel received it.
struct ReceivedFrame {
  CanFrame frame;
  /// CLOCK_REALTIME: software stamps have no other clock. 0: no stamp, as in the first moment after
  /// the first socket of the computer asked for them.
  std::int64_t stamp_ns = 0;
};

enum class CanStatus : std::uint8_t {
  kOk,
  kBusDown,        ///< sending: the queue is full, so the bus takes nothing (ENOBUFS, EAGAIN)
  kInterfaceDown,  ///< it is down or gone; the socket works again once it is up
  kBadFrame,       ///< a frame that this bus can not carry
  kError,          ///< another error of the system: `error`
};
const char* words(CanStatus status) noexcept;

struct CanResult {
  CanStatus status = CanStatus::kOk;
  int frames = 0;  ///< sent, or received
  int error = 0;   ///< errno, if not kOk and not kBadFrame
};

/// Everything but opening is noexcept, without heap, and returns at once.
class CanSocket {
 public:
  static constexpr int kMaxFrames = 16;  ///< that a system call takes at most

  /// Throws InputError: no such interface, no CAN interface, no CAN in this kernel, CAN FD on an
  /// interface that is set up without.
  explicit CanSocket(const CanSocketConfig& config);
  ~CanSocket();
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  /// For ppoll: readable. Writable says nothing, it is true while the queue is full.
  int descriptor() const noexcept { return descriptor_; }

  /// Sends the frames in order until one is not taken; those after it are dropped, not kept.
  CanResult send(std::span<const CanFrame> frames) noexcept;

  /// Takes what has arrived, as much as `frames` holds. Error frames are among it
  /// (`CanFrame::error`): look at them before decoding.
  CanResult receive(std::span<ReceivedFrame> frames) noexcept;

  /// Frames that the kernel threw away because nobody received them in time, since opening; known
  /// as of the last frame received.
  std::uint64_t overflowed() const noexcept { return overflowed_; }

 private:
  int descriptor_ = -1;
  bool fd_ = false;
  std::uint32_t last_overflow_ = 0;
  std::uint64_t overflowed_ = 0;
};

/// Takes what has arrived, frame by frame, in at most `most_rounds` calls of receive: a bus may
/// never fall silent. Returns whether nothing is left.
template <typename Use>
bool for_each_frame(CanSocket& socket, int most_rounds, const Use& use) {
  std::array<ReceivedFrame, CanSocket::kMaxFrames> received;
  for (int round = 0; round < most_rounds; ++round) {
    const int frames = socket.receive(received).frames;
    for (int i = 0; i < frames; ++i) use(received[i]);
    if (frames < CanSocket::kMaxFrames) return true;
  }
  return false;
}

}  // namespace sandrunner
