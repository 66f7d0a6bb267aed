// SPDX-License-Identifier: BSD-3-Clause
// Expected figures were counted bit by bit from the frame formats, apart from this code.
#include "drivers/can/bus_load.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace sandrunner {
namespace {

constexpr BusRates k1M2M{1e6, 2e6}, k1M5M{1e6, 5e6}, k1M8M{1e6, 8e6};

constexpr FrameShape classic(int bytes, bool extended = false) {
  return {bytes, extended, false, false};
}
constexpr FrameShape fd(int bytes, bool extended = false) { return {bytes, extended, true, true}; }

double us(double s) { return s * 1e6; }

TEST(BusLoadTest, ClassicFramesHaveTheirBits) {
  struct Row {
    int bytes;
    BitCount standard, extended;
  };
  for (const Row& row :
       {Row{0, {47, 55}, {67, 80}}, Row{1, {55, 65}, {75, 90}}, Row{2, {63, 75}, {83, 100}},
        Row{4, {79, 95}, {99, 120}}, Row{6, {95, 115}, {115, 140}}, Row{7, {103, 125}, {123, 150}},
        Row{8, {111, 135}, {131, 160}}}) {
    SCOPED_TRACE(row.bytes);
    const FrameBits standard = frame_bits(classic(row.bytes));
    EXPECT_EQ(standard.slow.nominal, row.standard.nominal);
    EXPECT_EQ(standard.slow.worst, row.standard.worst);
    EXPECT_EQ(standard.fast.worst, 0);
    const FrameBits extended = frame_bits(classic(row.bytes, true));
    EXPECT_EQ(extended.slow.nominal, row.extended.nominal);
    EXPECT_EQ(extended.slow.worst, row.extended.worst);
  }
}

TEST(BusLoadTest, FdFramesHaveTheirBitsAndTimes) {
  struct Row {
    int bytes;
    BitCount fast;
    double at_2m[2], at_5m[2], at_8m[2], extended_5m, extended_8m;  // us, to a tenth
  };
  for (const Row& row : {
           Row{4, {64, 73}, {62.0, 70.5}, {42.8, 48.6}, {38.0, 43.1}, 71.8, 66.2},
           Row{8, {96, 113}, {78.0, 90.5}, {49.2, 56.6}, {42.0, 48.1}, 79.8, 71.2},
           Row{12, {128, 153}, {94.0, 110.5}, {55.6, 64.6}, {46.0, 53.1}, 87.8, 76.2},
           Row{16, {160, 193}, {110.0, 130.5}, {62.0, 72.6}, {50.0, 58.1}, 95.8, 81.2},
           Row{20, {197, 238}, {128.5, 153.0}, {69.4, 81.6}, {54.6, 63.8}, 104.8, 86.9},
           Row{24, {229, 278}, {144.5, 173.0}, {75.8, 89.6}, {58.6, 68.8}, 112.8, 91.9},
           Row{32, {293, 358}, {176.5, 213.0}, {88.6, 105.6}, {66.6, 78.8}, 128.8, 101.9},
           Row{64, {549, 678}, {304.5, 373.0}, {139.8, 169.6}, {98.6, 118.8}, 192.8, 141.9},
       }) {
    SCOPED_TRACE(row.bytes);
    const FrameBits standard = frame_bits(fd(row.bytes));
    EXPECT_EQ(standard.slow.nominal, 30);
    EXPECT_EQ(standard.slow.worst, 34);
    EXPECT_EQ(standard.fast.nominal, row.fast.nominal);
    EXPECT_EQ(standard.fast.worst, row.fast.worst);
    const FrameBits extended = frame_bits(fd(row.bytes, true));
    EXPECT_EQ(extended.slow.nominal, 49);
    EXPECT_EQ(extended.slow.worst, 57);
    // Half a tenth, and what adding up rounds.
    constexpr double kTenth = 0.05 + 1e-9;
    const auto expect_times = [&](const BusRates& rates, const double(&expected)[2]) {
      const WireTime time = wire_time(fd(row.bytes), rates);
      EXPECT_NEAR(us(time.nominal_s), expected[0], kTenth);
      EXPECT_NEAR(us(time.worst_s), expected[1], kTenth);
    };
    expect_times(k1M2M, row.at_2m);
    expect_times(k1M5M, row.at_5m);
    expect_times(k1M8M, row.at_8m);
    EXPECT_NEAR(us(wire_time(fd(row.bytes, true), k1M5M).worst_s), row.extended_5m, kTenth);
    EXPECT_NEAR(us(wire_time(fd(row.bytes, true), k1M8M).worst_s), row.extended_8m, kTenth);
  }
}

TEST(BusLoadTest, FdFrameWithoutBitRateSwitchIsSlowThroughout) {
  const FrameShape shape{8, false, true, false};
  EXPECT_EQ(frame_bits(shape).slow.nominal, 30 + 96);
  EXPECT_EQ(frame_bits(shape).slow.worst, 34 + 113);
  EXPECT_EQ(frame_bits(shape).fast.worst, 0);
}

TEST(BusLoadTest, ExchangesTakeTheirTimesAndSoManyMotorsFit) {
  struct Row {
    const char* name;
    std::array<FrameShape, 2> exchange;
    BusRates rates;
    double nominal_us, worst_us;
    int motors[3];  // at 1, 2, 4 kHz
  };
  for (const Row& row : {
           Row{"MIT 8+6", {classic(8), classic(6)}, k1M5M, 206.0, 250.0, {3, 1, 0}},
           Row{"MIT 8+8", {classic(8), classic(8)}, k1M5M, 222.0, 270.0, {2, 1, 0}},
           Row{"MIT in CAN FD", {fd(8), fd(8)}, k1M5M, 98.4, 113.2, {7, 3, 1}},
           Row{"moteus", {fd(24, true), fd(16)}, k1M5M, 156.8, 185.4, {4, 2, 1}},
           Row{"moteus torque", {fd(20, true), fd(16)}, k1M5M, 150.4, 177.4, {4, 2, 1}},
           Row{"ODrive", {classic(4), classic(8)}, k1M5M, 190.0, 230.0, {3, 1, 0}},
           Row{"FD 1M/2M", {fd(8), fd(8)}, k1M2M, 156.0, 181.0, {4, 2, 1}},
           Row{"FD 1M/8M", {fd(8), fd(8)}, k1M8M, 84.0, 96.2, {8, 4, 2}},
       }) {
    SCOPED_TRACE(row.name);
    const WireTime time = wire_time(row.exchange, row.rates);
    EXPECT_NEAR(us(time.nominal_s), row.nominal_us, 0.051);
    EXPECT_NEAR(us(time.worst_s), row.worst_us, 0.051);
    EXPECT_EQ(motors_that_fit(row.exchange, 1000.0, row.rates), row.motors[0]);
    EXPECT_EQ(motors_that_fit(row.exchange, 2000.0, row.rates), row.motors[1]);
    EXPECT_EQ(motors_that_fit(row.exchange, 4000.0, row.rates), row.motors[2]);
  }
}

TEST(BusLoadTest, LoadsOfThreeMotorsOnABus) {
  const auto percent = [](FrameShape command, FrameShape reply, double rate_hz) {
    const std::array frames = {command, reply, command, reply, command, reply};
    return std::lround(100.0 * bus_load(frames, rate_hz, k1M5M).worst);
  };
  EXPECT_EQ(percent(fd(8), fd(8), 1000.0), 34);
  EXPECT_EQ(percent(fd(24, true), fd(16), 1000.0), 56);
  EXPECT_EQ(percent(classic(8), classic(6), 1000.0), 75);
  EXPECT_EQ(percent(classic(8), classic(8), 1000.0), 81);
  EXPECT_EQ(percent(classic(8), classic(6), 4000.0), 300);
  EXPECT_EQ(percent(fd(24, true), fd(16), 4000.0), 222);
  EXPECT_EQ(percent(fd(8), fd(8), 4000.0), 136);
}

// Four frames of 200 us make exactly 80 %.
TEST(BusLoadTest, ExactlyTheLimitFits) {
  const std::array exchange = {classic(8, true)};  // 160 bits at worst
  const BusRates rates{0.8e6, 0.8e6};              // 200 us
  EXPECT_EQ(motors_that_fit(exchange, 1000.0, rates), 4);
  EXPECT_EQ(motors_that_fit(exchange, 1001.0, rates), 3);
}

TEST(BusLoadTest, NothingFitsWhereNothingIsKnown) {
  EXPECT_EQ(motors_that_fit({}, 1000.0, k1M5M), 0);
  const std::array exchange = {classic(8)};
  EXPECT_EQ(motors_that_fit(exchange, 0.0, k1M5M), 0);
  EXPECT_EQ(motors_that_fit(exchange, 1e6, k1M5M), 0);
}

}  // namespace
}  // namespace sandrunner
