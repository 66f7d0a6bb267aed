// SPDX-License-Identifier: BSD-3-Clause
// Needs CAN in the kernel and the interfaces vcan0 (CAN FD) and vcan1, with the right to configure
// them: true in tools that boot a kernel of their own, rarely elsewhere.
#include "drivers/can/can_socket.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "drivers/can/can_error.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

constexpr std::array kEverything = {CanFilter{0, 0, false}, CanFilter{0, 0, true}};

CanSocketConfig on(const char* interface, bool fd = true) {
  CanSocketConfig config;
  config.interface = interface;
  config.fd = fd;
  config.filters = kEverything;
  return config;
}

std::string refusal(const CanSocketConfig& config) {
  return error_of([&] { const CanSocket socket(config); });
}

// Sets up interfaces through any socket.
class Interface {
 public:
  explicit Interface(const std::string& name) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    name.copy(request_.ifr_name, sizeof request_.ifr_name - 1);
  }
  ~Interface() { close(socket_); }
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;

  bool exists() { return ioctl(socket_, SIOCGIFINDEX, &request_) == 0; }
  bool set_up(bool up) {
    if (ioctl(socket_, SIOCGIFFLAGS, &request_) != 0) return false;
    const int flags = up ? request_.ifr_flags | IFF_UP : request_.ifr_flags & ~IFF_UP;
    request_.ifr_flags = static_cast<short>(flags);
    return ioctl(socket_, SIOCSIFFLAGS, &request_) == 0;
  }
  bool set_mtu(int mtu) {
    if (!set_up(false)) return false;
    request_.ifr_mtu = mtu;
    const bool done = ioctl(socket_, SIOCSIFMTU, &request_) == 0;
    return set_up(true) && done;
  }

 private:
  int socket_;
  ifreq request_{};
};

bool has_can() {
  const int socket = ::socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (socket >= 0) close(socket);
  return socket >= 0;
}

CanFrame frame_with(std::uint32_t id, int length, bool fd = false) {
  CanFrame frame;
  frame.id = id;
  frame.fd = frame.brs = fd;
  frame.length = static_cast<std::uint8_t>(length);
  for (int i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(id + i);
  return frame;
}

// Waits for frames with a deadline; fewer only if no more come.
std::vector<ReceivedFrame> receive(CanSocket& socket, std::size_t expected) {
  std::vector<ReceivedFrame> all;
  while (all.size() < expected) {
    pollfd ready{socket.descriptor(), POLLIN, 0};
    if (poll(&ready, 1, 2000) <= 0) break;
    std::array<ReceivedFrame, 40> some;
    const CanResult result = socket.receive(some);
    EXPECT_EQ(result.status, CanStatus::kOk);
    if (result.frames == 0) break;
    all.insert(all.end(), some.begin(), some.begin() + result.frames);
  }
  return all;
}

bool is_empty(CanSocket& socket) {
  std::array<ReceivedFrame, 1> some;
  const CanResult result = socket.receive(some);
  return result.status == CanStatus::kOk && result.frames == 0;
}

bool same(const CanFrame& a, const CanFrame& b) {
  return a.id == b.id && a.extended == b.extended && a.fd == b.fd && a.brs == b.brs &&
         a.error == b.error && a.length == b.length &&
         std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin());
}

TEST(CanSocketOpeningTest, WithoutCanInTheKernelItSaysSo) {
  if (has_can()) GTEST_SKIP() << "this kernel has CAN";
  EXPECT_EQ(refusal(on("can0")),
            "CAN interface can0: this kernel has no CAN (modules can and can-raw)");
}

class CanSocketTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_can()) GTEST_SKIP() << "this kernel has no CAN";
    for (const char* const name : {"vcan0", "vcan1"}) {
      if (!Interface(name).exists()) GTEST_SKIP() << "there is no interface " << name;
    }
  }
};

TEST_F(CanSocketTest, InterfacesThatDoNotServeAreRefused) {
  EXPECT_EQ(refusal(on("nocan7")), "CAN interface nocan7: there is no such interface");
  EXPECT_EQ(refusal(on("")), "CAN interface : there is no such interface");
  EXPECT_EQ(refusal(on("a-name-longer-than-linux-allows")),
            "CAN interface a-name-longer-than-linux-allows: there is no such interface");
  EXPECT_EQ(refusal(on("lo")), "CAN interface lo: it is not a CAN interface");
  Interface vcan1("vcan1");
  if (!vcan1.set_mtu(CAN_MTU)) GTEST_SKIP() << "no right to configure interfaces";
  EXPECT_EQ(refusal(on("vcan1")),
            "CAN interface vcan1: it is set up for classic CAN, CAN FD is needed "
            "(ip link set vcan1 ... fd on)");
  EXPECT_EQ(refusal(on("vcan1", false)), "");
  EXPECT_TRUE(vcan1.set_mtu(CANFD_MTU));
}

TEST_F(CanSocketTest, FramesOfEveryKindArriveAsTheyWereSentInOrderWithStamps) {
  CanSocket a(on("vcan0")), b(on("vcan0"));
  // The kernel begins to stamp a moment after it was asked to.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  for (bool stamped = false; !stamped;) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    ASSERT_EQ(a.send(std::array{frame_with(1, 1)}).status, CanStatus::kOk);
    const auto first = receive(b, 1);
    stamped = first.size() == 1 && first[0].stamp_ns != 0;
  }
  std::vector<CanFrame> sent;
  for (int length = 0; length <= 8; ++length) sent.push_back(frame_with(0x123, length));
  for (const int length : {0, 8, 12, 16, 20, 24, 32, 48, 64}) {
    sent.push_back(frame_with(0x321, length, true));
  }
  sent.push_back(frame_with(0x8001, 24, true));
  sent.back().extended = true;
  sent.push_back(frame_with(0x1FFFFFFF, 3));
  sent.back().extended = true;
  sent.push_back(frame_with(0x55, 12, true));
  sent.back().brs = false;
  ASSERT_GT(sent.size(), static_cast<std::size_t>(CanSocket::kMaxFrames));
  const CanResult result = a.send(sent);
  EXPECT_EQ(result.status, CanStatus::kOk);
  EXPECT_EQ(result.frames, static_cast<int>(sent.size()));

  const auto received = receive(b, sent.size());
  ASSERT_EQ(received.size(), sent.size());
  const std::int64_t now_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                                  std::chrono::system_clock::now().time_since_epoch())
                                  .count();
  std::int64_t last_ns = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_TRUE(same(received[i].frame, sent[i])) << i;
    EXPECT_GE(received[i].stamp_ns, last_ns);
    EXPECT_LE(received[i].stamp_ns, now_ns);
    EXPECT_GT(received[i].stamp_ns, now_ns - 10'000'000'000);
    last_ns = received[i].stamp_ns;
  }
  EXPECT_TRUE(is_empty(b));
  EXPECT_TRUE(is_empty(a)) << "a socket does not hear itself";
  EXPECT_EQ(b.overflowed(), 0u);
}

TEST_F(CanSocketTest, FiltersLetNothingElseThrough) {
  const std::array filters = {CanFilter{0x100, 0x7FF, false}, CanFilter{0x8100, 0x1FFFFFFF, true}};
  CanSocketConfig config = on("vcan0");
  config.filters = filters;
  CanSocket filtered(config), sender(on("vcan0"));
  std::array frames = {frame_with(0x101, 1), frame_with(0x100, 2), frame_with(0x100, 3),
                       frame_with(0x8100, 4), frame_with(0x8101, 5)};
  frames[2].extended = frames[3].extended = frames[4].extended = true;
  ASSERT_EQ(sender.send(frames).status, CanStatus::kOk);
  const auto received = receive(filtered, 2);
  ASSERT_EQ(received.size(), 2u);
  EXPECT_EQ(received[0].frame.length, 2);
  EXPECT_EQ(received[1].frame.length, 4);
  EXPECT_TRUE(is_empty(filtered));
}

TEST_F(CanSocketTest, WithoutLoopbackNobodyOnThisComputerHearsIt) {
  CanSocketConfig config = on("vcan0");
  config.loopback = false;
  CanSocket quiet(config), loud(on("vcan0")), listener(on("vcan0"));
  ASSERT_EQ(quiet.send(std::array{frame_with(1, 1)}).status, CanStatus::kOk);
  ASSERT_EQ(loud.send(std::array{frame_with(2, 1)}).status, CanStatus::kOk);
  const auto received = receive(listener, 1);
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].frame.id, 2u);
}

TEST_F(CanSocketTest, BusOffIsHeardWhateverTheFilters) {
  CanSocketConfig config = on("vcan0");
  config.filters = {};
  CanSocket socket(config);
  // A virtual bus takes error frames from anybody; this driver sends none.
  CanSocket helper(on("vcan0"));
  can_frame raw{};
  raw.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
  raw.can_dlc = CAN_ERR_DLC;
  ASSERT_EQ(write(helper.descriptor(), &raw, sizeof raw), static_cast<ssize_t>(sizeof raw));
  const auto received = receive(socket, 1);
  ASSERT_EQ(received.size(), 1u);
  ASSERT_TRUE(received[0].frame.error);
  EXPECT_TRUE(decode_can_error(received[0].frame).bus_off);
}

TEST_F(CanSocketTest, FramesThatNobodyReceivesInTimeAreCounted) {
  CanSocketConfig config = on("vcan0");
  config.receive_buffer_bytes = 1;  // as small as the kernel lets it be
  CanSocket slow(config), sender(on("vcan0"));
  constexpr int kSent = 200;
  for (int i = 0; i < kSent; ++i) {
    ASSERT_EQ(sender.send(std::array{frame_with(i, 8)}).status, CanStatus::kOk);
  }
  std::array<ReceivedFrame, kSent> some;
  const int kept = slow.receive(some).frames;
  EXPECT_LT(kept, kSent);
  // The count comes with the next frame that finds room.
  ASSERT_EQ(sender.send(std::array{frame_with(0, 8)}).status, CanStatus::kOk);
  ASSERT_EQ(receive(slow, 1).size(), 1u);
  EXPECT_EQ(slow.overflowed(), static_cast<std::uint64_t>(kSent - kept));
}

TEST_F(CanSocketTest, FramesThatTheBusCanNotCarryAreNotSent) {
  CanSocket socket(on("vcan0")), classic(on("vcan0", false)), listener(on("vcan0"));
  const auto status = [](CanSocket& by, const CanFrame& frame) {
    const CanResult result = by.send(std::array{frame_with(1, 1), frame});
    EXPECT_EQ(result.frames, 0);
    return result.status;
  };
  EXPECT_EQ(status(socket, frame_with(0x800, 1)), CanStatus::kBadFrame);
  EXPECT_EQ(status(socket, frame_with(1, 9)), CanStatus::kBadFrame);
  EXPECT_EQ(status(socket, frame_with(1, 21, true)), CanStatus::kBadFrame);
  EXPECT_EQ(status(classic, frame_with(1, 8, true)), CanStatus::kBadFrame);
  CanFrame error = frame_with(1, 8);
  error.error = true;
  EXPECT_EQ(status(socket, error), CanStatus::kBadFrame);
  EXPECT_TRUE(is_empty(listener));
}

TEST_F(CanSocketTest, AnInterfaceThatGoesDownIsSaidAndTheSameSocketWorksWhenItIsBack) {
  CanSocket socket(on("vcan1")), listener(on("vcan1"));
  Interface vcan1("vcan1");
  if (!vcan1.set_up(false)) GTEST_SKIP() << "no right to configure interfaces";
  EXPECT_EQ(socket.send(std::array{frame_with(1, 1)}).status, CanStatus::kInterfaceDown);
  std::array<ReceivedFrame, 4> some;
  EXPECT_EQ(listener.receive(some).status, CanStatus::kInterfaceDown);
  EXPECT_EQ(listener.receive(some).status, CanStatus::kOk) << "the kernel says it once";
  EXPECT_EQ(socket.send(std::array{frame_with(1, 1)}).status, CanStatus::kInterfaceDown);
  ASSERT_TRUE(vcan1.set_up(true));
  EXPECT_EQ(socket.send(std::array{frame_with(1, 1)}).status, CanStatus::kOk);
  EXPECT_EQ(receive(listener, 1).size(), 1u);
}

// A serial line that nobody reads stands for a bus that takes nothing.
TEST_F(CanSocketTest, AFullQueueIsABusThatIsDownAndWorksAgainOnceItDrains) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(master, 0);
  ASSERT_EQ(grantpt(master) | unlockpt(master), 0);
  const int line = open(ptsname(master), O_RDWR | O_NOCTTY);
  ASSERT_GE(line, 0);
  termios settings{};
  tcgetattr(line, &settings);
  cfmakeraw(&settings);
  tcsetattr(line, TCSANOW, &settings);
  int discipline = 17;  // N_SLCAN
  if (ioctl(line, TIOCSETD, &discipline) != 0) {
    close(line);
    close(master);
    GTEST_SKIP() << "no serial-line CAN (module slcan)";
  }
  std::array<char, 64> name{};
  ASSERT_EQ(ioctl(line, SIOCGIFNAME, name.data()), 0);
  ASSERT_TRUE(Interface(name.data()).set_up(true));
  {
    CanSocket socket(on(name.data(), false));
    const std::array frames = {frame_with(1, 8), frame_with(2, 8)};
    CanResult result;
    for (int i = 0; i < 5000 && result.status == CanStatus::kOk; ++i) result = socket.send(frames);
    EXPECT_EQ(result.status, CanStatus::kBusDown);
    EXPECT_EQ(result.error, ENOBUFS);
    // Drained, it takes frames again.
    for (int i = 0; i < 5000 && result.status != CanStatus::kOk; ++i) {
      std::array<char, 4096> text;
      pollfd ready{master, POLLIN, 0};
      while (poll(&ready, 1, 10) > 0 && read(master, text.data(), text.size()) > 0) {
      }
      result = socket.send(frames);
    }
    EXPECT_EQ(result.status, CanStatus::kOk);
  }
  close(line);
  close(master);
}

}  // namespace
}  // namespace sandrunner
