// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer on the hardware file, from its bytes to the plan of the buses: it is refused with an
// InputError, or it is a robot whose every drive can be told something.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "drivers/robot/bus_plan.h"
#include "drivers/robot/drive.h"
#include "drivers/robot/hardware_fit.h"
#include "rt/base/errors.h"
#include "tests/drivers/fuzz/fuzz_frame.h"
#include "tests/drivers/robot/example.h"

namespace sandrunner {
namespace {

std::string example(const std::string& name) {
  std::stringstream text;
  text << std::ifstream(std::string(SANDRUNNER_HARDWARE_EXAMPLES) + "/" + name).rdbuf();
  require(!text.str().empty());
  return text.str();
}

/// Some bytes of an example replaced: where, two bytes; how many, one; by the rest.
std::string spliced(std::string text, const std::string& bytes) {
  if (bytes.size() < 3) return text;
  const auto number = [&](int i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
  };
  text.replace((number(0) << 8 | number(1)) % text.size(), number(2), bytes.substr(3));
  return text;
}

/// Each line an assignment of --set; one that is refused is not there.
void set_lines(ConfigTree& tree, const std::string& lines) {
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) {
    try {
      tree.set(line);
    } catch (const InputError&) {
    }
  }
}

void check_drives(const HardwareConfig& hardware) {
  for (const DriveConfig& config : hardware.drives) {
    require(config.bus >= 0 && config.bus < static_cast<int>(hardware.buses.size()));
    Drive drive(config, hardware);
    CanFrame frame;
    drive.off_frame(frame);
    require(is_sendable(frame));
    drive.command_frame({1.0, 1.0, 1.0, 1.0, 1.0}, frame);
    require(is_sendable(frame));
    require(!frame.fd || hardware.buses[config.bus].format != CanFormat::kClassic);
  }
}

void check_plan(const HardwareConfig& hardware) {
  const std::vector<PlannedBus> plan = plan_buses(hardware);
  require(plan.size() == hardware.buses.size());
  int drives = 0;
  for (const PlannedBus& bus : plan) {
    drives += bus.drives;
    require(std::isfinite(bus.load.worst) && bus.load.worst >= bus.load.nominal);
    require((bus.load.nominal > 0.0) == (bus.drives > 0));
    require(overload(hardware, bus).empty() != bus.overloaded());
    require(bus.overloaded() || bus.most_rate_hz >= hardware.rate_hz);
  }
  require(drives == kNumJoints && !plan_table(hardware, plan).empty());
}

HardwareConfig read(ConfigTree& tree) {
  GateConfig gate = example_gate();
  HardwareConfig hardware = read_hardware_config(tree, example_robot(), gate);
  tree.reject_unknown();
  fit_gate_to(hardware, gate);
  for (const double limit_nm : gate.torque_limit_nm) require(limit_nm >= 0.0 && limit_nm <= 63.45);
  fit_drives_to(gate, hardware);
  return hardware;
}

void check(ConfigTree& tree) {
  const HardwareConfig hardware = read(tree);
  check_drives(hardware);
  check_plan(hardware);
  // What a recording keeps of it is read back as the same.
  ConfigTree again;
  again.add_text(tree.effective(), "effective");
  require(read(again).buses.size() == hardware.buses.size());
  require(again.effective() == tree.effective());
}

}  // namespace
}  // namespace sandrunner

/// The first byte says what the rest is: a whole file, a splice of an example, or assignments.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandrunner;  // NOLINT(google-build-using-namespace)
  static const std::array<std::string, 2> kExamples = {example("mit.toml"), example("moteus.toml")};
  if (size < 1) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::string& text = kExamples[data[0] & 1];
  ConfigTree tree;
  try {
    if (data[0] % 8 < 2) {
      tree.add_text(bytes, "fuzz");
    } else if (data[0] % 8 < 5) {
      tree.add_text(spliced(text, bytes), "fuzz");
    } else {
      tree.add_text(text, "fuzz");
      set_lines(tree, bytes);
    }
    check(tree);
  } catch (const InputError&) {
  }
  return 0;
}
