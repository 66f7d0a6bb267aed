// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/can/can_error.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>

namespace sandrunner {
namespace {

CanFrame error_frame(std::uint32_t classes, std::uint8_t controller = 0) {
  CanFrame frame;
  frame.error = true;
  frame.id = classes;
  frame.length = 8;
  frame.data[1] = controller;
  return frame;
}

TEST(CanErrorTest, SaysWhatTheControllerSays) {
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_BUSOFF)).bus_off);
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_RESTARTED)).restarted);
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_ACK)).no_acknowledge);
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_TX_TIMEOUT)).send_timeout);
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_LOSTARB)).lost_arbitration);
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_PROT)).protocol_violation);
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_TRX)).transceiver);
  EXPECT_TRUE(decode_can_error(error_frame(CAN_ERR_BUSERROR)).bus_error);
  const auto controller = [](std::uint8_t detail) {
    return decode_can_error(error_frame(CAN_ERR_CRTL, detail));
  };
  EXPECT_TRUE(controller(CAN_ERR_CRTL_RX_OVERFLOW).receive_overflow);
  EXPECT_TRUE(controller(CAN_ERR_CRTL_TX_OVERFLOW).send_overflow);
  EXPECT_TRUE(controller(CAN_ERR_CRTL_RX_WARNING).error_warning);
  EXPECT_TRUE(controller(CAN_ERR_CRTL_TX_WARNING).error_warning);
  EXPECT_TRUE(controller(CAN_ERR_CRTL_RX_PASSIVE).error_passive);
  EXPECT_TRUE(controller(CAN_ERR_CRTL_TX_PASSIVE).error_passive);
  EXPECT_TRUE(controller(CAN_ERR_CRTL_ACTIVE).error_active);
}

TEST(CanErrorTest, TheGravestIsSaidInWords) {
  EXPECT_STREQ(words(decode_can_error(error_frame(CAN_ERR_BUSOFF | CAN_ERR_BUSERROR))), "bus-off");
  EXPECT_STREQ(words(decode_can_error(error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE))),
               "error passive");
  EXPECT_STREQ(words(CanError{}), "");
}

TEST(CanErrorTest, AnOrdinaryFrameSaysNothingAndAShortOneOnlyItsClass) {
  CanFrame frame = error_frame(CAN_ERR_BUSOFF | CAN_ERR_CRTL, 0xFF);
  frame.length = 1;
  EXPECT_TRUE(decode_can_error(frame).bus_off);
  EXPECT_FALSE(decode_can_error(frame).error_passive);
  frame.error = false;
  EXPECT_STREQ(words(decode_can_error(frame)), "");
}

}  // namespace
}  // namespace sandrunner
