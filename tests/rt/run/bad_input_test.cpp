// SPDX-License-Identifier: BSD-3-Clause
// Bad input: one clear line, exit code 2, before any work.
#include <sys/resource.h>

#include <cstring>

#include "policy/policy_file.h"
#include "policy/safetensors.h"
#include "sim/robot/embedded.h"
#include "tests/policy/random_policy.h"
#include "tests/support/program_test.h"
#include "tests/support/small_robot.h"

namespace sandrunner {
namespace {

class BadInputTest : public ProgramTest {
 protected:
  BadInputTest() : ProgramTest(SANDRUNNER_PROGRAM) {
    write_policy_file(folder_.path("good"), random_policy_file());
  }

  /// Also asks for results, to see that none begin.
  void expect_refused(const std::string& arguments, const std::string& cause) {
    const std::set<std::string> before = files_in("");
    ProgramTest::expect_refused("--out results " + arguments, cause);
    EXPECT_EQ(error().rfind("sandrunner: ", 0), 0u) << error();
    EXPECT_EQ(files_in(""), before) << arguments;
  }
  void write(const std::string& name, const std::string& content) {
    write_file(folder_.path(name), content);
  }
};

TEST_F(BadInputTest, OptionsAreRefusedBeforeAnyWork) {
  expect_refused("--nosuch", "--nosuch");
  expect_refused("walk", "walk");
  expect_refused("--policy", "--policy");
  expect_refused("--start fly", "fly");
  expect_refused("--duration -1", "--duration: -1");
  expect_refused("--duration 0", "--duration: 0");
  expect_refused("--duration nan", "--duration: nan");
  expect_refused("--duration inf", "--duration: inf");
  expect_refused("--duration long", "long");
  expect_refused("--seed 1.5", "1.5");
  expect_refused("--seed x", "x");
  expect_refused("--seed -1", "-1");
  expect_refused("--seed 99999999999999999999", "99999999999999999999");
  expect_refused("--command 1 0 0",
                 "unexpected '0': several numbers of one option need commas, as in 1,0,0");
}

TEST_F(BadInputTest, AGuessIsLedToWhatIsThere) {
  write("robot.toml", std::string(embedded_robot_file("go2.toml")));
  write("file", "");
  expect_refused("--config robot.toml", "robot.toml: found a robot file (its key 'urdf')");
  expect_refused("--robot go1", "expected a robot file, or 'go2'");
  expect_refused("replay", "unexpected 'replay', did you mean 'sandrunner-replay'?");
  ProgramTest::expect_refused("--record file", "--record: 'file' is a file, expected a folder");
  expect_refused("--hardware robot.toml --dry-run --terrain grass",
                 "--terrain: is the simulator's, expected it without --hardware");
  expect_refused("--hardware robot.toml --dry-run --seed 2", "--seed: is the simulator's");
}

TEST_F(BadInputTest, ANewRobotIsWrittenOnceAndStands) {
  write("my.urdf", std::string(embedded_robot_file("go2.urdf")));
  ASSERT_EQ(run("new-robot my.urdf my.toml"), 0) << error();
  EXPECT_NE(output().find("limits.power_w: battery voltage"), std::string::npos) << output();
  EXPECT_NE(output().find("finished on its feet"), std::string::npos) << output();
  expect_refused("new-robot my.urdf my.toml", "'my.toml' exists, expected a new file");
  expect_refused("new-robot my.toml other.toml", "my.toml: not a URDF");
  for (const char* option : {"--hardware my.toml", "--start walk", "--duration nan", "--seed 1"}) {
    expect_refused(std::string(option) + " new-robot my.urdf other.toml",
                   "new-robot: stands a simulated robot, expected no --");
  }
}

TEST_F(BadInputTest, EmptyValuesAreRefused) {
  for (const char* option : {"--policy", "--robot", "--terrain", "--command", "--dds-security",
                             "--config", "--set", "--record", "--seed"}) {
    expect_refused(std::string(option) + " ''", std::string(option) + ": found an empty value");
  }
  ProgramTest::expect_refused("--out ''", "--out: found an empty value");
  for (const char* option : {"--duration", "--start", "--clock"}) {
    expect_refused(std::string(option) + " ''", option);
  }
}

TEST_F(BadInputTest, AnOptionIsNotTheValueOfAnother) {
  ProgramTest::expect_refused("--out --record", "--out: found '--record', expected a value");
  expect_refused("--policy -x", "--policy: found '-x', expected a value");
  expect_refused("--command --view", "--command: found '--view', expected a value");
}

TEST_F(BadInputTest, WhatWasProbablyMeantIsSaid) {
  expect_refused("--terain rigid", "'--terain', did you mean '--terrain'?");
  expect_refused("--dds_security=x", "did you mean '--dds-security'?");
  expect_refused("rt-rpeort", "did you mean 'rt-report'?");
  expect_refused("--terrain dry-snad", "did you mean 'dry-sand'?");
  expect_refused("--plan", "unexpected '--plan' there, expected it behind check");
  expect_refused("--set controller.walk.kp=3", "did you mean 'controller.walk.kp_nmprad'?");
}

TEST_F(BadInputTest, ValuesThatDoNotFitAreRefusedInOurWords) {
  expect_refused("--duration 20s", "--duration: found '20s', expected a number");
  expect_refused("--policy good --policy good", "--policy: found 2 of them, expected one");
  expect_refused("--clock fast", "--clock: found 'fast', expected one of lockstep,realtime");
  expect_refused("--duration", "--duration: found no value, expected S");
  expect_refused("--gui", "unexpected '--gui': --view shows the run in a browser");
}

TEST_F(BadInputTest, FilesThatAreTakenForPoliciesAreNamed) {
  write("walk.pt", std::string("PK\x03\x04", 4) + std::string(200, '\x11'));
  expect_refused("--policy walk.pt", "found a zip archive (a checkpoint of PyTorch, or .npz)");
  write("walk.onnx", std::string("\x08\x08\x12\x07pytorch", 11) + std::string(200, '\x11'));
  expect_refused("--policy walk.onnx", "found an ONNX file, expected a policy file (safetensors)");
  write("raibo.toml", "name = \"raibo\"\n");
  expect_refused("--policy raibo.toml", "found text, expected a policy file");
}

TEST_F(BadInputTest, ASettingWithoutItsSignIsExplained) {
  expect_refused("--set terrain.friction 0.6", "unexpected '0.6'");
  expect_refused("--set terrain.friction=0.6 0.7",
                 "'0.7': several numbers of one option need commas, "
                 "as in 1,0,0; --set takes path=value");
}

TEST_F(BadInputTest, CommandsAreRefusedWithFileAndLine) {
  expect_refused("--command 1,2", "'1,2' has 2 numbers, expected 3");
  expect_refused("--command fast", "'fast'");
  expect_refused("--command " + std::string(300, '1') + ",", "--command: '111");
  write("command.csv", "t_s,vx,vy,wz\n0,1,0,0\n1,oops,0,0\n");
  expect_refused("--command command.csv", "command.csv:3: '1,oops,0,0'");
}

TEST_F(BadInputTest, TerrainsAreRefusedWithFileAndLine) {
  expect_refused("--terrain nosuch", "'nosuch' is neither a preset");
  write("unknown.toml", "[terrain]\nfriction = 0.5\nslipperiness = 3\n");
  expect_refused("--terrain unknown.toml", "unknown.toml:3: unknown key 'terrain.slipperiness'");
  write("nan.toml", "[terrain]\nsigma_flat_npm3 = nan\n");
  expect_refused("--terrain nan.toml", "nan.toml:2: terrain.sigma_flat_npm3: found nan");
}

TEST_F(BadInputTest, SettingsAreRefusedWithTheirKey) {
  expect_refused("--set nonsense", "--set: found 'nonsense', expected");
  expect_refused("--set terrain.nosuch=1", "unknown key 'terrain.nosuch'");
  expect_refused("--set controller.gate.tilt_fault_deg=nan", "found nan");
  expect_refused("--config absent.toml", "absent.toml: cannot be read");
  expect_refused("--config .", "cannot be read");
  expect_refused("--config /dev/zero", "/dev/zero: cannot be read (not a regular file)");
  write("unknown.toml", "[controller]\nspeed = 1\n");
  expect_refused("--config unknown.toml", "unknown.toml:2: unknown key 'controller.speed'");
}

TEST_F(BadInputTest, DamagedPoliciesAreRefused) {
  const std::string bytes = read_file(folder_.path("good"));
  expect_refused("--policy absent",
                 "absent: cannot be read (No such file or directory), expected a policy file");
  expect_refused("--policy .", ".: cannot be read (not a regular file)");
  write("truncated", bytes.substr(0, 300000));
  expect_refused("--policy truncated", "'truncated': ");
  TensorFile file = read_safetensors(folder_.path("good"));
  file.tensors.at("golden.action").values[100] += 0.01f;
  write_safetensors(folder_.path("golden"), file);
  expect_refused("--policy golden", "golden example fails at step");
}

TEST_F(BadInputTest, BrokenRobotFilesAreRefused) {
  expect_refused("--set robot=absent.toml", "absent.toml: cannot be read");
  const std::string map(embedded_robot_file("raibo.toml"));
  const std::string urdf(embedded_robot_file("raibo.urdf"));
  write("map.toml", map);
  expect_refused("--set robot=map.toml", "raibo.urdf: cannot be read");
  write("raibo.urdf", urdf.substr(0, urdf.size() / 2));
  expect_refused("--set robot=map.toml", "raibo.urdf: not a ");
  write("raibo.urdf", urdf);
  write("map.toml", map + "[wheels]\nradius_m = 0.1\n");
  expect_refused("--set robot=map.toml", "unknown key 'wheels.radius_m'");
  expect_refused("--robot map.toml", "map.toml:68: unknown key 'wheels.radius_m'");
  expect_refused("--robot absent.toml", "absent.toml: cannot be read");
  expect_refused(
      "--robot /dev/null",
      "/dev/null: cannot be read (not a regular file), expected raibo, go2 or a robot file");
  expect_refused("--robot " + write_small_robot(folder_),
                 "policy 'raibo' is for another robot: found joint 1 'LF_HAA', expected 'fl_roll' "
                 "of robot 'small'; train one with sandrunner-train --robot FILE, or let it only "
                 "stand with --policy none");
  expect_refused("--robot raibo.urdf", "raibo.urdf: found XML, expected a robot file (TOML)");
}

/// `piece(i)` until there are this many bytes.
template <typename Piece>
std::string repeated(std::size_t bytes, const Piece& piece) {
  std::string text;
  for (int i = 0; text.size() < bytes; ++i) text += piece(i);
  return text;
}

/// So that other programs of the computer do not count.
double processor_time_of_children_s() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

// Each is what a parser takes long for, up to minutes: its length, or the square of its parts.
TEST_F(BadInputTest, WhatTakesAParserLongIsRefusedBeforeItBegins) {
  constexpr std::size_t kMega = std::size_t{1} << 20;
  const auto expect_soon = [&](const std::string& arguments, const std::string& cause) {
    const double before_s = processor_time_of_children_s();
    expect_refused(arguments, cause);
    EXPECT_LT(processor_time_of_children_s() - before_s, 2.0) << arguments;
  };
  const auto number = [](int i) { return std::to_string(i); };
  write("keys.toml", repeated(4 * kMega, [&](int i) { return "k" + number(i) + "=1\n"; }));
  expect_soon("--config keys.toml", "keys.toml: found 4194");
  expect_soon("--robot keys.toml", "keys.toml: found 4194");
  expect_soon("--terrain keys.toml", "keys.toml: found 4194");
  expect_soon("--hardware keys.toml --dry-run", "keys.toml: found 4194");
  write("most.toml", repeated(kMega - 20, [&](int i) { return "k" + number(i) + "=1\n"; }));
  expect_soon("--config most.toml", "most.toml:1: unknown key 'k0'");

  write("robot.toml", std::string(embedded_robot_file("raibo.toml")));
  const auto expect_urdf = [&](const std::string& element, const std::string& cause) {
    std::string text(embedded_robot_file("raibo.urdf"));
    write("raibo.urdf", text.insert(text.rfind("</robot>"), element));
    expect_soon("--policy none --robot robot.toml", cause);
  };
  for (const char* value : {"=\"\" ", "=1 "}) {
    const auto attribute = [&](int i) { return "a" + number(i) + value; };
    expect_urdf("<x " + repeated(kMega / 2, attribute) + "/>", "more than 64 attributes");
  }
  expect_urdf(repeated(kMega / 2, [](int) { return "<x/>"; }), "more than 4000 elements");
  expect_urdf(std::string(kMega, ' '), "at most 1048576 of a URDF");

  const auto expect_policy = [&](const std::string& header, const std::string& cause) {
    std::string text(8, '\0');
    const std::uint64_t size = header.size();
    std::memcpy(text.data(), &size, sizeof size);
    write("large", text + header);
    expect_soon("--policy large", cause);
  };
  const auto tensor = [&](int i) { return "\"" + number(i) + "\":{},"; };
  expect_policy("{" + repeated(kMega - 100, tensor) + "\"z\":{}}", "more than 1000 keys");
  expect_policy("{\"z\":{\"shape\":[" + repeated(kMega - 100, [](int) { return "{},"; }) + "{}]}}",
                "objects nested more than 2 deep");
  expect_policy("{" + std::string(kMega, ' ') + "}", "expected at most 1048576");

  write("long.csv", "t_s,vx,vy,wz\n" + repeated(17 * kMega, [](int) { return "0,0,0,0\n"; }));
  expect_soon("--command long.csv", "more than 16777216 bytes");
}

TEST_F(BadInputTest, UnwritableOutputFoldersAreRefused) {
  write("file", "precious");
  const std::set<std::string> before = files_in("");
  ProgramTest::expect_refused("--out file", "--out: 'file' is a file, expected a folder");
  ProgramTest::expect_refused("--out " + std::string(300, 'a'), "cannot be written");
  for (const char* folder : {"file/results", "/proc/results"}) {
    ProgramTest::expect_refused(std::string("--out ") + folder,
                                "--out: folder '" + std::string(folder) + "'");
  }
  EXPECT_EQ(files_in(""), before);
  EXPECT_EQ(read_file(folder_.path("file")), "precious");
}

TEST_F(BadInputTest, NamesWithLineBreaksStillGiveOneLine) {
  for (const char* option : {"--terrain", "--command", "--policy", "--config", "--set", ""}) {
    expect_refused(std::string(option) + " 'a\nb'", "a");
  }
}

}  // namespace
}  // namespace sandrunner
