// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/can/can_error.h"

#include <linux/can.h>
#include <linux/can/error.h>

namespace sandrunner {

CanError decode_can_error(const CanFrame& frame) noexcept {
  CanError error;
  if (!frame.error) return error;
  const auto has = [&](std::uint32_t bits) { return (frame.id & bits) != 0; };
  error.bus_off = has(CAN_ERR_BUSOFF);
  error.restarted = has(CAN_ERR_RESTARTED);
  error.send_timeout = has(CAN_ERR_TX_TIMEOUT);
  error.no_acknowledge = has(CAN_ERR_ACK);
  error.lost_arbitration = has(CAN_ERR_LOSTARB);
  error.protocol_violation = has(CAN_ERR_PROT);
  error.transceiver = has(CAN_ERR_TRX);
  error.bus_error = has(CAN_ERR_BUSERROR);
  if (frame.length < CAN_ERR_DLC) return error;  // the details are missing
  if (has(CAN_ERR_CRTL)) {
    const std::uint8_t detail = frame.data[1];
    error.receive_overflow = (detail & CAN_ERR_CRTL_RX_OVERFLOW) != 0;
    error.send_overflow = (detail & CAN_ERR_CRTL_TX_OVERFLOW) != 0;
    error.error_warning = (detail & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0;
    error.error_passive = (detail & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0;
    error.error_active = (detail & CAN_ERR_CRTL_ACTIVE) != 0;
  }
  return error;
}

const char* words(const CanError& error) noexcept {
  if (error.bus_off) return "bus-off";
  if (error.restarted) return "restarted after bus-off";
  if (error.transceiver) return "transceiver fault";
  if (error.no_acknowledge) return "no node acknowledges";
  if (error.error_passive) return "error passive";
  if (error.send_timeout) return "send timeout";
  if (error.receive_overflow) return "receive overflow";
  if (error.send_overflow) return "send overflow";
  if (error.error_warning) return "many errors";
  if (error.protocol_violation) return "bit, form or stuff error";
  if (error.bus_error) return "bus error";
  if (error.lost_arbitration) return "lost arbitration";
  if (error.error_active) return "errors gone";
  return "";
}

}  // namespace sandrunner
