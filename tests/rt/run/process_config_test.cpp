// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/process_config.h"

#include <gtest/gtest.h>

#include <string>

#include "sim/robot/embedded.h"
#include "tests/rt/support.h"
#include "tests/support/all_joints.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

TEST(ProcessConfigTest, LaterLayersWin) {
  const TemporaryFolder folder;
  write_file(folder.path("terrain.toml"), R"([terrain]
    kind = "granular"
    sigma_flat_npm3 = 2e6
    friction = 0.5
    drag = 11.0
    packing = 0.51)");
  write_file(folder.path("first.toml"), "terrain.friction = 0.4\nterrain.drag = 12.0\n");
  write_file(folder.path("second.toml"), "terrain.drag = 13.0\ncontroller.stand.kp_nmprad = 77.0");
  ConfigTree tree;
  sim::add_terrain_layer(tree, "wet-sand");  // sigma_flat 10e6, sigma_cone 0.6e6, friction 0.8
  sim::add_terrain_layer(tree, folder.path("terrain.toml"));
  tree.add_file(folder.path("first.toml"));
  tree.add_file(folder.path("second.toml"));
  tree.set("terrain.packing=0.52");
  tree.set("terrain.packing=0.53");
  const ProcessConfig config = read_process_config(tree, nullptr);
  const sim::GroundParameters& ground = config.simulator.terrain.patches.front().ground;
  EXPECT_EQ(ground.sigma_cone_npm3, 0.6e6);  // preset
  EXPECT_EQ(ground.sigma_flat_npm3, 2e6);    // terrain file
  EXPECT_EQ(ground.friction, 0.4);           // --config
  EXPECT_EQ(ground.drag, 13.0);              // the later --config
  EXPECT_EQ(ground.packing, 0.53);           // the later --set
  EXPECT_EQ(config.controller.stand.kp_nmprad, 77.0);
}

TEST(ProcessConfigTest, SettingsReachSimulatorControllerAndGate) {
  const ProcessConfig config =
      config_of("rigid", {"sim.sensor_delay_ticks=5", "sim.noise.joint_velocity_radps=0.25",
                          "sim.torque_speed_line=true", "sim.stall_torque_nm=99",
                          "policy.latency_ticks=20", "controller.walk.kd_nmsprad=0.7",
                          "controller.damping.kd_nmsprad=3", "controller.gate.tilt_fault_deg=50",
                          "controller.gate.joints_fault_ticks=9", "summary.motor_constant=2.5"});
  EXPECT_EQ(config.simulator.sensor_delay_ticks, 5);
  EXPECT_EQ(config.simulator.noise.joint_velocity_radps, 0.25);
  EXPECT_EQ(config.simulator.torque_speed_line.stall_torque_nm,
            (LegJoints<double>{99.0, 99.0, 99.0}));
  EXPECT_EQ(config.simulator.torque_speed_line.no_load_speed_radps[2], 28.1);
  EXPECT_EQ(config.controller.walk.latency_ticks, 20u);
  EXPECT_EQ(config.controller.walk.kd_nmsprad, 0.7);
  EXPECT_EQ(config.controller.damping.kd_nmsprad, (LegJoints<double>{3.0, 3.0, 3.0}));
  EXPECT_EQ(config.controller.gate.tilt_fault_deg, 50.0);
  EXPECT_EQ(config.controller.gate.joints_fault_ticks, 9u);
  EXPECT_EQ(config.motor_constant[2], 2.5);
}

TEST(ProcessConfigTest, ARobotThatShipsIsGivenByItsName) {
  const ProcessConfig go2 = config_of("rigid", {"robot=go2"});
  EXPECT_EQ(go2.robot.description.name, "go2");
  EXPECT_EQ(go2.controller.gate.continuous_torque_nm, go2.robot.continuous_torque_nm);
  EXPECT_EQ(go2.controller.gate.speed_fault_radps, go2.robot.speed_fault_radps);
  EXPECT_EQ(go2.motor_constant, go2.robot.motor_constant_nmpsqrtw);
}

TEST(ProcessConfigTest, TheRobotsFileSaysWhetherDrivesObeyTheirTorqueSpeedLine) {
  const auto stall_nm = [](const std::vector<std::string>& assignments) {
    return config_of("rigid", assignments).simulator.torque_speed_line.stall_torque_nm;
  };
  EXPECT_EQ(stall_nm({}), (LegJoints<double>{}));
  EXPECT_EQ(stall_nm({"robot=go2"}), (LegJoints<double>{36.7, 36.7, 70.4}));
  EXPECT_EQ(stall_nm({"robot=go2", "sim.torque_speed_line=false"}), (LegJoints<double>{}));
}

TEST(ProcessConfigTest, ASettingLowersTheSpeedFaultOfEachJointButRaisesNone) {
  const auto fault_radps = [](const std::string& value) {
    return config_of("rigid", {"robot=go2", "controller.gate.speed_fault_radps=" + value})
        .controller.gate.speed_fault_radps;
  };
  EXPECT_EQ(fault_radps("20"), (LegJoints<double>{20.0, 20.0, 20.0}));
  EXPECT_EQ(fault_radps("30"), (LegJoints<double>{30.0, 30.0, 24.0}));
  EXPECT_EQ(fault_radps("[40, 35, 22]"), (LegJoints<double>{40.0, 35.0, 22.0}));
}

TEST(ProcessConfigTest, PolicyGivesTheDefaultsOfTheWalk) {
  PolicySpec spec = random_policy_file().spec;
  spec.kp_nmprad = 41.0;
  spec.kd_nmsprad = 0.6;
  spec.torque_limit_nm = 55.0;
  spec.yaw_command_clip_mps2 = 2.2;
  ProcessConfig config = config_of("rigid", {}, &spec);
  EXPECT_EQ(config.controller.walk.kp_nmprad, 41.0);
  EXPECT_EQ(config.controller.walk.kd_nmsprad, 0.6);
  EXPECT_EQ(config.controller.shaping.centripetal_limit_mps2, 2.2);
  for (const double limit : config.robot.model.torque_limit_nm) EXPECT_EQ(limit, 55.0);
  // Its own standing gains are not the policy's, and settings win over the policy.
  EXPECT_EQ(config.controller.stand.kp_nmprad, 100.0);
  config = config_of("rigid", {"controller.walk.kp_nmprad=30"}, &spec);
  EXPECT_EQ(config.controller.walk.kp_nmprad, 30.0);
  EXPECT_EQ(config.controller.walk.kd_nmsprad, 0.6);
  // A policy cannot raise what the drives can do.
  spec.torque_limit_nm = 500.0;
  for (const double limit : config_of("rigid", {}, &spec).robot.model.torque_limit_nm) {
    EXPECT_EQ(limit, 63.45);
  }
}

TEST(ProcessConfigTest, ARobotThatIsDrivenGentlyStopsAsSoonAsOthers) {
  PolicySpec spec = random_policy_file().spec;
  spec.envelope.acceleration_mps2 = spec.envelope.yaw_acceleration_radps2 = 0.8;
  const auto stop_of = [&](const std::vector<std::string>& assignments) {
    return config_of("rigid", assignments, &spec).controller.walk.stop_deceleration_mps2;
  };
  EXPECT_EQ(stop_of({}), 0.8);  // not more than it was trained for
  EXPECT_EQ(stop_of({"controller.shaping.acceleration_mps2=0.05"}), 0.8);
  EXPECT_EQ(stop_of({"controller.shaping.acceleration_mps2=5"}), 1.0);
  EXPECT_EQ(stop_of({"controller.walk.stop_deceleration_mps2=0.5"}), 0.5);
}

TEST(ProcessConfigTest, RobotGivesTheLimitsOfTheGate) {
  const GateConfig raibo = config_of("rigid").controller.gate;
  EXPECT_EQ(raibo.joint_lower_rad[0], -1.5708);
  EXPECT_EQ(raibo.joint_upper_rad[8], -0.0262);
  EXPECT_EQ(raibo.speed_limit_radps, all_joints(25.7));
  EXPECT_EQ(raibo.torque_limit_nm, all_joints(63.45));

  std::string urdf(embedded_robot_file("raibo.urdf"));
  const auto replace_all = [&](const std::string& from, const std::string& to) {
    for (auto at = urdf.find(from); at != std::string::npos; at = urdf.find(from, at)) {
      urdf.replace(at, from.size(), to);
      at += to.size();
    }
  };
  replace_all("effort=\"63.45\" velocity=\"25.7\"", "effort=\"44\" velocity=\"21\"");
  replace_all("lower=\"-2.4696\"", "lower=\"-2.45\"");
  std::string map(embedded_robot_file("raibo.toml"));
  map.replace(map.find("nominal_rad = [0.0, 0.559836"), 28, "nominal_rad = [0.0, 0.6");
  const TemporaryFolder folder;
  write_file(folder.path("raibo.urdf"), urdf);
  write_file(folder.path("other.toml"), map);
  const ProcessConfig config = config_of("rigid", {"robot=" + folder.path("other.toml")});
  EXPECT_EQ(config.controller.gate.joint_lower_rad[5], -2.45);
  EXPECT_EQ(config.controller.gate.speed_limit_radps, all_joints(21.0));
  EXPECT_EQ(config.controller.gate.torque_limit_nm, all_joints(44.0));
  EXPECT_EQ(config.controller.stand.nominal_rad[10], 0.6);
}

TEST(ProcessConfigTest, InvalidValueIsRefused) {
  const struct {
    const char* assignment;
    const char* expected;
  } cases[] = {
      {"terrain.stiffness_npm=-1", "terrain.stiffness_npm: found -1"},
      {"terrain.sigma_flat_npm3=-1e6", "terrain.sigma_flat_npm3: found -1000000.0"},
      {"terrain.friction=nan", "terrain.friction: found nan"},
      {"terrain.friction=inf", "terrain.friction: found inf"},
      {"terrain.friction=\"a\"", "found \"a\", expected a finite number"},
      {"terrain.friction=[1]", "found an array of 1"},
      {"terrain.effects.filter=1", "found 1, expected true or false"},
      {"terrain.kind=lava", "found \"lava\", expected one of"},
      {"terrain.foot.shape=square", "found \"square\""},
      {"sim.sensor_delay_ticks=64", "found 64"},
      {"sim.sensor_delay_ticks=1.5", "found 1.5, expected a whole number"},
      {"sim.noise.orientation_rad=-0.1", "found -0.1"},
      {"sim.solver_tolerance_ns=0", "found 0"},
      {"policy.latency_ticks=0", "found 0"},
      {"policy.latency_ticks=40", "found 40"},
      {"controller.walk.kp_nmprad=-1", "found -1"},
      {"controller.walk.stop_calm_s=0", "found 0"},     // Stand would take over at full speed
      {"controller.walk.stop_time_s=0", "found 0"},     // likewise
      {"controller.damping.kd_nmsprad=0", "found 0"},   // nothing would let the robot down
      {"controller.damping.fault_s=0.1", "found 0.1"},  // not for long enough
      {"controller.stand.blend_s=0.5", "found 0.5"},    // it would topple on sand
      {"controller.gate.tilt_fault_deg=nan", "found nan"},
      {"controller.gate.policy_fault_ticks=1", "found 1"},
      {"controller.gate.power_limit_w=5001", "expected a finite number from 0 to 5000"},
      {"controller.gate.speed_fault_radps=61", "expected a finite number from 0 to 60"},
      {"controller.gate.joints_fault_ticks=-1", "found -1"},
      {"summary.motor_constant=0", "found 0"},
      {"robot=7", "found 7, expected a string"},
  };
  for (const auto& c : cases) {
    const std::string assignment = c.assignment;
    const std::string place = "--set: " + assignment.substr(0, assignment.find('=')) + ": ";
    expect_refused([&] { config_of("rigid", {assignment}); }, {place, c.expected});
  }
}

TEST(ProcessConfigTest, UnknownKeyIsRefusedWithItsPlace) {
  expect_refused([] { config_of("rigid", {"terrain.nosuch=1"}); },
                 {"unknown key 'terrain.nosuch'"});
  expect_refused([] { config_of("rigid", {"controller.walk.kp=1"}); },
                 {"unknown key 'controller.walk.kp'"});
  expect_refused([] { config_of("rigid", {"controller.gate.tilt_fault_degs=1"}); },
                 {"'controller.gate.tilt_fault_deg'"});  // the hint
  const TemporaryFolder folder;
  write_file(folder.path("my.toml"), "[sim]\nseed = 3\n");
  ConfigTree tree;
  sim::add_terrain_layer(tree, "rigid");
  tree.add_file(folder.path("my.toml"));
  expect_refused([&] { read_process_config(tree, nullptr); },
                 {folder.path("my.toml") + ":2: unknown key 'sim.seed'"});
}

TEST(ProcessConfigTest, ARecordingMayHaveSettingsThatNoRunMayHaveAnyMore) {
  const sim::Robot raibo = sim::load_raibo();
  for (const auto& [setting, value_of] :
       {std::pair{"controller.stand.blend_s=0.5",
                  +[](const ControllerConfig& c) { return c.stand.blend_s; }},
        std::pair{"controller.walk.stop_calm_s=0.05",
                  +[](const ControllerConfig& c) { return 10.0 * c.walk.stop_calm_s; }},
        std::pair{"controller.damping.kd_nmsprad=0.25",
                  +[](const ControllerConfig& c) { return 2.0 * c.damping.kd_nmsprad[0]; }},
        std::pair{"controller.damping.fault_s=0.25",
                  +[](const ControllerConfig& c) { return 2.0 * c.damping.fault_s; }}}) {
    ConfigTree tree;
    sim::add_terrain_layer(tree, "rigid");
    tree.set(setting);
    EXPECT_EQ(value_of(read_process_config(tree, nullptr, &raibo, Ranges::kRecorded).controller),
              0.5)
        << setting;
    ConfigTree run;
    sim::add_terrain_layer(run, "rigid");
    run.set(setting);
    EXPECT_THROW(read_process_config(run, nullptr, &raibo), InputError) << setting;
  }
}

TEST(ProcessConfigTest, EffectiveSettingsReadBackToThemselves) {
  const TemporaryFolder folder;
  write_file(folder.path("terrain.toml"), R"([terrain]
    name = "mixed"
    cone_angle_deg = 57.3
    [[terrain.patch]]
    from_x_m = 1.0
    preset = "rigid"
    [[terrain.patch]]
    from_x_m = 2.5
    sigma_flat_npm3 = 3e6)");
  const PolicySpec spec = random_policy_file().spec;
  for (const std::string& terrain : {std::string("grass"), folder.path("terrain.toml")}) {
    const ProcessConfig config = config_of(
        terrain, {"sim.noise.joint_position_rad=0.1", "controller.stand.fold_s=0.7"}, &spec);
    // As the program reads it: over a preset; and alone, without the policy.
    ConfigTree over_preset, alone;
    sim::add_terrain_layer(over_preset, "wet-sand");
    over_preset.add_text(config.effective, "config.toml");
    alone.add_text(config.effective, "config.toml");
    EXPECT_EQ(read_process_config(over_preset, &spec).effective, config.effective);
    const ProcessConfig again = read_process_config(alone, nullptr);
    EXPECT_EQ(again.effective, config.effective);
    EXPECT_EQ(again.controller.walk.kp_nmprad, spec.kp_nmprad);
    EXPECT_EQ(again.controller.stand.fold_s, 0.7);
    ASSERT_EQ(again.simulator.terrain.patches.size(), config.simulator.terrain.patches.size());
    for (std::size_t i = 0; i < again.simulator.terrain.patches.size(); ++i) {
      const sim::TerrainPatch& patch = again.simulator.terrain.patches[i];
      const sim::TerrainPatch& before = config.simulator.terrain.patches[i];
      EXPECT_EQ(patch.from_x_m, before.from_x_m);
      EXPECT_EQ(patch.ground.kind, before.ground.kind);
      EXPECT_EQ(patch.ground.sigma_flat_npm3, before.ground.sigma_flat_npm3);
      EXPECT_EQ(patch.ground.cone_angle_rad, before.ground.cone_angle_rad);
    }
  }
}

TEST(ProcessConfigTest, AnglesAreShownAsTheyWereMeant) {
  const std::string effective = config_of("dry-sand", {}, nullptr).effective;
  EXPECT_NE(effective.find("terrain.cone_angle_deg = 60.0\n"), std::string::npos) << effective;
  EXPECT_NE(effective.find("terrain.crater_angle_deg = 45.0\n"), std::string::npos) << effective;
}

}  // namespace
}  // namespace sandrunner
