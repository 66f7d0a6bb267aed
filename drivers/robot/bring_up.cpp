// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/bring_up.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "drivers/robot/drive.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

/// The drive's answer; nothing if there is none.
std::optional<double> ask(const DriveQuestion& question, CanSocket& socket) {
  for (int attempt = 0; attempt < 5; ++attempt) {
    if (socket.send({&question.request, 1}).status != CanStatus::kOk) continue;
    for (int wait = 0; wait < 10; ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      std::array<ReceivedFrame, CanSocket::kMaxFrames> received;
      const CanResult result = socket.receive(received);
      for (int i = 0; i < result.frames; ++i) {
        if (const std::optional<double> value = question.answer(received[i].frame)) return value;
      }
    }
  }
  return std::nullopt;
}

/// The protection against a drive whose numbers mean something else: what it can tell, it is asked.
/// What is wrong, empty if nothing is.
std::string settings_problem(const std::vector<DriveQuestion>& questions, CanSocket& socket) {
  for (const DriveQuestion& q : questions) {
    const std::optional<double> answer = ask(q, socket);
    if (!answer) return fmt::format("does not report its {} ({})", q.what, q.source);
    if (std::fabs(*answer - q.expected) > 1e-3 * q.expected) {
      return fmt::format("its {} is {:.6g}, configured is {:.6g}", q.what, *answer, q.expected);
    }
  }
  return "";
}

/// What is wrong with the drive of joint `j`, empty if nothing is.
std::string problem_of(const HardwareConfig& config, const GateConfig& gate,
                       const CanSockets& sockets, const FoundDrive& found, int j) {
  const DriveConfig& drive = config.drives[j];
  // The first answer may come after the exchange; one in twenty lost is a bad bus.
  if (found.replies < found.requests - found.requests / 20) {
    return fmt::format(
        "{} of {} requests answered; look at its power, its id, its bus, and who else has that id",
        found.replies, found.requests);
  }
  if (found.commands > 0) {
    return fmt::format("{} commands of another program to it", found.commands);
  }
  if (found.replies > found.requests) {
    return fmt::format(
        "{} answers to {} requests: two drives have that id, or another program speaks to it",
        found.replies, found.requests);
  }
  const double q = found.position_rad;
  if (q < gate.joint_lower_rad[j] - gate.joint_fault_rad ||
      q > gate.joint_upper_rad[j] + gate.joint_fault_rad) {
    return fmt::format(
        "is at {:.3f} rad, where the joint (from {:.3f} to {:.3f}) cannot be: its zero, sign or "
        "gear, or another drive",
        q, gate.joint_lower_rad[j], gate.joint_upper_rad[j]);
  }
  if (found.fault != 0) {
    return fmt::format("reports a fault: {}", drive_fault_words(drive, found.fault));
  }
  const std::string problem = settings_problem(
      std::visit([&](const auto& d) { return drive_questions(d, config.drive_timeout_s); },
                 drive.drive),
      *sockets[drive.bus]);
  if (!problem.empty()) return problem;
  const bool hidden = std::visit([](const auto& d) { return hides_timeout(d); }, drive.drive);
  if (!hidden || config.timeout_unverified) return "";
  return "cannot report its time-out over CAN: set it in the drive with the maker's tool, then set "
         "hardware.timeout_unverified=true";
}

}  // namespace

std::vector<std::string> drive_problems(const HardwareConfig& config, const RobotDescription& robot,
                                        const GateConfig& gate, const CanSockets& sockets,
                                        const JointArray<FoundDrive>& found) {
  std::vector<std::string> problems;
  for (int j = 0; j < kNumJoints; ++j) {
    if (!sockets[config.drives[j].bus]) continue;
    const std::string problem = problem_of(config, gate, sockets, found[j], j);
    if (problem.empty()) continue;
    problems.push_back(fmt::format("{}: {}", drive_name(config, robot, j), problem));
  }
  return problems;
}

void require_drives(const HardwareConfig& config, const RobotDescription& robot,
                    const GateConfig& gate, const CanSockets& sockets) {
  DriveLook look(config, sockets);
  for (int exchange = 0; exchange < kLookExchanges; ++exchange) look.exchange();
  const std::vector<std::string> problems =
      drive_problems(config, robot, gate, sockets, look.drives());
  if (!problems.empty()) throw InputError(problems.front());
}

}  // namespace sandrunner
