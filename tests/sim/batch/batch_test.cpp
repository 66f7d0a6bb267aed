// SPDX-License-Identifier: BSD-3-Clause
// A robot's trajectory in the batch has the same bits at every width, in any lane, beside any
// neighbours and from any number of threads; and it is that of the simulator in double, to the
// precision of float.
#include "sim/batch/batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numeric>
#include <thread>
#include <vector>

#include "rt/core/processor.h"
#include "rt/core/state_hash.h"
#include "sim/robot/dynamics.h"
#include "sim/step/actuator.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

constexpr int kRobots = 64;
constexpr int kPeriods = 50;  // of 40 ticks: 2,000 ticks

enum Kind { kSand, kFlatRock, kRoughRock, kSpring, kPatches, kUnevenPatches, kMud, kNumKinds };

const Robot& raibo() {
  static const Robot robot = load_raibo();
  return robot;
}
const Robot& soles() {
  static const Robot robot = robot_on_soles();
  return robot;
}
FootProfile<double> foot_of(const Robot& robot) {
  return make_foot_profile(one_patch(ground_of_kind(GroundKind::kGranular)), robot.model);
}
const FootProfile<double>& foot() {
  static const FootProfile<double> profile = foot_of(raibo());
  return profile;
}

GroundParameters random_ground(Draw& draw, Kind kind) {
  GroundParameters g;
  g.friction = draw(0.4, 1.1);
  g.kind = kind == kSand     ? GroundKind::kGranular
           : kind == kSpring ? GroundKind::kLinear
           : kind == kMud    ? GroundKind::kMud
                             : GroundKind::kRigid;
  g.sigma_flat_npm3 = draw(1e6, 1e7);
  g.sigma_cone_npm3 = draw(0.15e6, 0.6e6);
  g.recruitment = draw(1.5, 2.5);
  g.stroke_stiffness_npm = draw(50.0, 2000.0);
  g.stiffness_npm = draw(5e3, 30e3);
  if (draw(0.0, 1.0) < 0.3) g.layer_depth_m = draw(0.01, 0.2);
  g.strength_pa = draw(2e3, 20e3);
  if (kind == kSpring) g.coupling_npm = draw(0.0, 1.0) < 0.7 ? draw(100.0, 5e3) : 0.0;
  return g;
}

ShapeParameters random_shape(Draw& draw, Kind kind) {
  ShapeParameters s;
  if (kind == kRoughRock || kind == kUnevenPatches) {
    s.roughness_m = draw(0.005, 0.03);
    s.roughness_seed = static_cast<std::uint64_t>(draw(1.0, 1e6));
  }
  if (kind == kUnevenPatches) {
    s.slope_rad = std::fmax(draw(-0.2, 0.2), 0.0);  // half of them have none
    s.slope_heading_rad = draw(-3.0, 3.0);
    s.dune_height_m = std::fmax(draw(-0.1, 0.1), 0.0);
    s.dune_length_m = draw(1.0, 4.0);
  }
  return s;
}

Terrain<float> random_terrain(Draw& draw, Kind kind, const Robot& robot) {
  const bool patches = kind == kPatches || kind == kUnevenPatches;
  TerrainDescription t =
      one_patch(random_ground(draw, patches ? kSand : kind), random_shape(draw, kind));
  if (patches) {
    // Borders under and just beside the robot, so that its feet stand on different patches.
    double from_x_m = -0.4;
    for (const Kind next : {kFlatRock, kSand, kSpring, kMud, kFlatRock}) {
      from_x_m += draw(0.1, 0.3);
      t.patches.push_back({from_x_m, random_ground(draw, next)});
    }
  }
  return convert_terrain<float>(make_terrain(t, foot_of(robot), robot.model));
}

RobotModel<float> random_model(Draw& draw, const Robot& robot) {
  RobotModel<double> m = robot.model;
  const auto scale = [&](Body<double>& body) {
    const double f = draw(0.8, 1.2);
    body.mass *= f;
    body.inertia = {f * body.inertia.xx, f * body.inertia.xy, f * body.inertia.xz,
                    f * body.inertia.yy, f * body.inertia.yz, f * body.inertia.zz};
    body.com = body.com + draw.vector(0.01);
  };
  scale(m.base);
  for (auto& leg : m.legs) {
    scale(leg.hip);
    scale(leg.thigh);
    scale(leg.shank);
    leg.foot = leg.foot + draw.vector(0.01);
  }
  m.friction_nm.fill(std::fmax(draw(-0.4, 0.4), 0.0));  // half of them have none
  return convert_model<float>(m);
}

RobotState<float> random_start(Draw& draw) {
  RobotState<double> x;
  x.rigid.position = {draw(-0.3, 0.3), draw(-0.3, 0.3), raibo().nominal_height_m + draw(0.0, 0.1)};
  x.rigid.orientation = integrate(Quaternion<double>{}, draw.vector(0.2));
  x.rigid.velocity = draw.vector(1.0);
  x.rigid.angular_velocity = draw.vector(1.0);
  for (int j = 0; j < kNumJoints; ++j) {
    x.rigid.q[j] = raibo().nominal_rad[j] + draw(-0.3, 0.3);
    x.rigid.qd[j] = draw(-2.0, 2.0);
  }
  RobotState<float> state;
  state.rigid = convert<float>(x.rigid);
  return state;
}

/// What happens to one robot: all of it follows from its number.
struct Story {
  explicit Story(int number, const Robot& robot = raibo())
      : draw(static_cast<std::uint64_t>(number) + 1) {
    kind = static_cast<Kind>(number % kNumKinds);
    model = random_model(draw, robot);
    terrain = random_terrain(draw, kind, robot);
    start = random_start(draw);
    later_terrain =
        random_terrain(draw, static_cast<Kind>((number / kNumKinds) % kNumKinds), robot);
    terrain_changes = static_cast<int>(draw(5.0, 45.0));
    reset = static_cast<int>(draw(5.0, 45.0));
    rate_hz = draw(1.5, 3.0);
    lift_rad = draw(0.0, 0.8);
    sway_rad = draw(0.0, 0.5);
    noise_rad = draw(0.0, 0.2);
    drive.kp = static_cast<float>(draw(40.0, 120.0));
    drive.kd = static_cast<float>(draw(0.3, 3.0));
    drive.torque_scale = static_cast<float>(draw(0.9, 1.1));
    drive.switch_tick = std::floor(static_cast<float>(draw(0.0, 40.0)));
    const TorqueSpeedLine& line = raibo().torque_speed_line;
    drive.line = drive_line<float>(line);
    drive.line.stall_torque_nm[0] *= 0.5f;
    if (number % 3 == 0) drive.line = {};
    drive.heat_factor = {1.0f, 0.8f, 0.5f};
    drive.target_before = drive.target = start.rigid.q;
  }

  /// Before a period: noisy targets of a trot, and what befalls it.
  void act(int period, Batch& batch, int place) {
    if (period == 0) {
      batch.set_model(place, model);
      batch.set_terrain(place, terrain);
    }
    if (period == 0 || period == reset) batch.set_state(place, start);
    if (period == terrain_changes) batch.set_terrain(place, later_terrain);
    drive.target_before = drive.target;
    for (int l = 0; l < kNumLegs; ++l) {
      const double phase = rate_hz * period / kPolicyHz + (l == 0 || l == 3 ? 0.0 : 0.5);
      const double moment = phase - std::floor(phase);
      const double lift = moment < 0.5 ? lift_rad : 0.0;
      const double offset[3] = {sway_rad * (moment < 0.5 ? 1.0 : -1.0), lift, -2.0 * lift};
      for (int j = 0; j < 3; ++j) {
        const double target =
            raibo().nominal_rad[3 * l + j] + offset[j] + draw(-noise_rad, noise_rad);
        drive.target[3 * l + j] = static_cast<float>(target);
      }
    }
    batch.set_drive(place, drive);
  }

  Draw draw;
  Kind kind;
  RobotModel<float> model;
  Terrain<float> terrain, later_terrain;
  RobotState<float> start;
  BatchDrive<float> drive;
  int terrain_changes, reset;
  double rate_hz, lift_rad, sway_rad, noise_rad;
};

/// Hashes of everything of each robot after every period, by its number.
using Hashes = std::vector<std::uint64_t>;

/// Robot `order[i]` at place i, the packs dealt to the threads one after the other.
Hashes run(const std::vector<int>& order, BatchWidth width, int threads = 1,
           const Robot& robot = raibo()) {
  flush_denormals_to_zero();
  Batch batch(static_cast<int>(order.size()), foot_of(robot), {}, width);
  std::vector<Story> stories;
  for (const int number : order) stories.emplace_back(number, robot);
  std::vector<StateHash> hashes(order.size());
  for (int period = 0; period < kPeriods; ++period) {
    for (int i = 0; i < batch.size(); ++i) stories[i].act(period, batch, i);
    const auto work = [&](int worker) {
      flush_denormals_to_zero();
      for (int p = worker; p < batch.packs(); p += threads) batch.advance(p, kTicksPerPolicyStep);
    };
    std::vector<std::thread> others;
    for (int t = 1; t < threads; ++t) others.emplace_back(work, t);
    work(0);
    for (std::thread& other : others) other.join();
    for (int i = 0; i < batch.size(); ++i) {
      using Words = std::array<std::uint32_t, sizeof(BatchRobot<float>) / sizeof(float)>;
      for (const std::uint32_t word : std::bit_cast<Words>(batch.robot(i))) {
        hashes[i].add(std::uint64_t{word});
      }
    }
  }
  Hashes by_number(kRobots);
  for (std::size_t i = 0; i < order.size(); ++i) by_number[order[i]] = hashes[i].value();
  return by_number;
}

std::vector<int> in_order() {
  std::vector<int> order(kRobots);
  std::iota(order.begin(), order.end(), 0);
  return order;
}
std::vector<int> shuffled(std::uint64_t seed) {
  std::vector<int> order = in_order();
  Draw draw(seed);
  for (int i = kRobots - 1; i > 0; --i) {
    std::swap(order[i], order[static_cast<int>(draw(0.0, i + 1.0))]);
  }
  return order;
}

/// Alone, one after the other: what all other runs are held against.
const Hashes& alone() {
  static const Hashes hashes = run(in_order(), BatchWidth::kOne);
  return hashes;
}

/// Numbers of the robots whose trajectories are not those that they have alone.
std::vector<int> different(const Hashes& hashes) {
  std::vector<int> numbers;
  for (int i = 0; i < kRobots; ++i) {
    if (hashes[i] != alone()[i]) numbers.push_back(i);
  }
  return numbers;
}
const std::vector<int> kNone;

/// The widths beside 1 that this processor runs.
const std::vector<BatchWidth>& pack_widths() {
  static const std::vector<BatchWidth> widths = [] {
    std::vector<BatchWidth> runs{BatchWidth::kEight};
    if (best_batch_width() == BatchWidth::kSixteen) {
      runs.push_back(BatchWidth::kSixteen);
    } else {
      std::cout << "width 16 is left out: this processor has no AVX-512\n";
    }
    return runs;
  }();
  return widths;
}

TEST(BatchTest, StoriesCoverEveryGroundKneesBaseAndStops) {
  // Otherwise the comparisons below would compare little.
  flush_denormals_to_zero();
  Batch batch(kRobots, foot(), {}, BatchWidth::kOne);
  std::vector<Story> stories;
  for (int i = 0; i < kRobots; ++i) stories.emplace_back(i);
  std::array<int, kNumKinds> feet_down{};
  int mixed = 0, knees_or_base = 0, past_stop = 0, finite = 0;
  for (int period = 0; period < kPeriods; ++period) {
    for (int i = 0; i < kRobots; ++i) {
      stories[i].act(period, batch, i);
      batch.advance(i, kTicksPerPolicyStep);
      const RobotState<float> x = batch.state(i);
      finite += std::isfinite(x.rigid.position.x + x.rigid.position.z + x.rigid.orientation.w);
      const BatchSums<float> sums = batch.sums(i);
      knees_or_base += sums.thigh_contact > 0.0f || sums.base_contact > 0.0f;
      past_stop += sums.ticks_past_stop > 0.0f;
      std::array<bool, kMaxRegions> stands_on{};
      for (const FootContact<float>& f : x.feet) {
        if (!(f.active > 0.0f)) continue;
        ++feet_down[stories[i].kind];
        stands_on[static_cast<int>(f.region)] = true;
      }
      mixed += std::count(stands_on.begin(), stands_on.end(), true) > 1;
    }
  }
  EXPECT_EQ(finite, kRobots * kPeriods);
  for (int kind = 0; kind < kNumKinds; ++kind) EXPECT_GT(feet_down[kind], 100) << kind;
  EXPECT_GT(mixed, 50);
  EXPECT_GT(knees_or_base, 20);
  EXPECT_GT(past_stop, 10);
  Hashes distinct = alone();
  std::sort(distinct.begin(), distinct.end());
  EXPECT_EQ(std::unique(distinct.begin(), distinct.end()), distinct.end());
}

TEST(BatchTest, SameBitsAtEveryWidth) {
  for (const BatchWidth width : pack_widths()) {
    EXPECT_EQ(different(run(in_order(), width)), kNone) << static_cast<int>(width);
  }
}

TEST(BatchTest, SameBitsAtEveryWidthOnFlatFeet) {
  const Hashes one = run(in_order(), BatchWidth::kOne, 1, soles());
  EXPECT_NE(one, alone());
  for (const BatchWidth width : pack_widths()) {
    EXPECT_EQ(run(in_order(), width, 1, soles()), one) << static_cast<int>(width);
  }
}

TEST(BatchTest, SameBitsInAnyLaneBesideAnyNeighbours) {
  for (const BatchWidth width : pack_widths()) {
    for (const std::uint64_t seed : {1, 2}) {
      EXPECT_EQ(different(run(shuffled(seed), width)), kNone)
          << static_cast<int>(width) << ' ' << seed;
    }
  }
}

TEST(BatchTest, SameBitsInAPackThatIsNotFull) {
  const std::vector<int> few{11, 5, 22};
  for (const BatchWidth width : pack_widths()) {
    const Hashes hashes = run(few, width);
    for (const int number : few) EXPECT_EQ(hashes[number], alone()[number]) << number;
  }
}

TEST(BatchTest, SameBitsFromTwoThreads) {
  for (const BatchWidth width : pack_widths()) {
    EXPECT_EQ(different(run(shuffled(3), width, 2)), kNone) << static_cast<int>(width);
  }
}

TEST(BatchTest, AgreesWithTheStepInDouble) {
  flush_denormals_to_zero();
  constexpr int kTicks = 200;
  // Waves so low, and slopes so slight, that the ground is met within the time.
  const std::pair<Kind, ShapeParameters> cases[] = {
      {kSand, {}},           {kFlatRock, {}},           {kRoughRock, waves(0.003)}, {kSpring, {}},
      {kSand, waves(0.003)}, {kSand, slope(0.03, 0.7)}, {kSpring, slope(0.03, 2.0)}};
  for (const auto& [kind, shape] : cases) {
    Draw draw(static_cast<std::uint64_t>(kind) + 100);
    const TerrainDescription ground = one_patch(random_ground(draw, kind), shape);
    const Terrain<double> terrain = make_terrain(ground, foot(), raibo().model);
    const RobotModel<double>& model = raibo().model;
    RobotState<double> x;
    x.rigid.q = raibo().nominal_rad;
    x.rigid.position.z = raibo().nominal_height_m + 0.005 + terrain.shape.crest;
    x.rigid.velocity = {0.5, 0.2, -0.5};
    BatchDrive<float> drive;
    drive.kp = 60.0f;
    drive.kd = 1.0f;
    const auto line = drive_line<double>(raibo().torque_speed_line);
    drive.line = drive_line<float>(raibo().torque_speed_line);
    drive.switch_tick = 120.0f;
    for (int j = 0; j < kNumJoints; ++j) {
      drive.target_before[j] = static_cast<float>(x.rigid.q[j]);
      drive.target[j] = static_cast<float>(x.rigid.q[j] + draw(-0.2, 0.2));
    }
    Batch batch(1, foot(), {}, BatchWidth::kOne);
    batch.set_model(0, convert_model<float>(model));
    batch.set_terrain(0, convert_terrain<float>(terrain));
    RobotState<float> start;
    start.rigid = convert<float>(x.rigid);
    batch.set_state(0, start);
    batch.set_drive(0, drive);
    batch.advance(0, kTicks);
    const RobotState<float> narrow = batch.state(0);

    RobotStepper<double> stepper;
    StepReport<double> report;
    double squared = 0.0, load = 0.0;
    for (int tick = 0; tick < kTicks; ++tick) {
      std::array<double, kNumJoints> torque_nm;
      for (int j = 0; j < kNumJoints; ++j) {
        const auto& target = tick < 120 ? drive.target_before : drive.target;
        torque_nm[j] =
            drive_torque<double>(j, x.rigid.q[j], x.rigid.qd[j],
                                 {.q = static_cast<double>(target[j]), .kp = 60.0, .kd = 1.0},
                                 model.torque_limit_nm[j], line);
        squared += torque_nm[j] * torque_nm[j];
      }
      stepper.step(model, foot(), terrain, {}, torque_nm, x, report);
      for (const auto& force : report.foot_force) load += force[2];
    }
    const Vec3<float>& at = narrow.rigid.position;
    const Vec3<double> off = x.rigid.position - Vec3<double>{at.x, at.y, at.z};
    double position = std::sqrt(dot(off, off)), velocity = 0.0;
    for (int j = 0; j < kNumJoints; ++j) {
      position = std::fmax(position, std::fabs(x.rigid.q[j] - narrow.rigid.q[j]));
      velocity = std::fmax(velocity, std::fabs(x.rigid.qd[j] - narrow.rigid.qd[j]));
    }
    EXPECT_GT(load / kTicks, 20.0) << kind;  // it stands on the ground
    EXPECT_LT(position, 1e-5) << kind;       // m, rad
    EXPECT_LT(velocity, 1e-3) << kind;       // rad/s
    EXPECT_NEAR(batch.sums(0).torque_squared / squared, 1.0, 1e-5) << kind;
  }
}

// The robot hangs in the air, thighs and knees drive with a torque one way while they turn one way.
double extension_power(float torque_sign, float speed_sign) {
  BatchRobot<float> robot;
  robot.model = convert_model<float>(raibo().model);
  robot.terrain = convert_terrain<float>(
      make_terrain(one_patch(ground_of_kind(GroundKind::kRigid)), foot(), raibo().model));
  robot.state.rigid.position = {0.0f, 0.0f, 5.0f};
  for (int j = 0; j < kNumJoints; ++j) {
    const bool pushes = j % 3 != 0;
    robot.state.rigid.q[j] = static_cast<float>(raibo().nominal_rad[j]);
    robot.state.rigid.qd[j] = pushes ? speed_sign * 2.0f : 0.0f;
    robot.drive.target[j] = robot.state.rigid.q[j] + (pushes ? torque_sign * 0.5f : 0.0f);
    robot.drive.target_before[j] = robot.drive.target[j];
  }
  robot.drive.kp = 20.0f;
  Batch batch(1, foot(), {}, BatchWidth::kOne);
  batch.set_robot(0, robot);
  batch.advance(0, 1);
  return batch.sums(0).extension_power;
}

TEST(BatchTest, ExtensionPowerCountsThighsAndKneesThatDriveAsTheyPushOff) {
  flush_denormals_to_zero();
  EXPECT_NEAR(extension_power(1.0f, 1.0f), 8 * 10.0 * 2.0, 1e-3);
  EXPECT_EQ(extension_power(-1.0f, -1.0f), 0.0);
  EXPECT_EQ(extension_power(1.0f, -1.0f), 0.0);
  EXPECT_EQ(extension_power(-1.0f, 1.0f), 0.0);
}

TEST(BatchTest, ThighsAndKneesPushOffInTheirPositiveDirection) {
  for (const auto& leg : raibo().model.legs) {
    const auto foot_at = [&](double thigh_rad, double knee_rad) {
      const auto pose = leg_pose(leg, 0.0, thigh_rad, knee_rad);
      const Vec3<double> foot = hip_to_base(leg, pose, pose.foot);
      const Vec3<double> hip = hip_to_base(leg, pose, leg.hfe);
      return foot - hip;
    };
    const double thigh_rad = raibo().nominal_rad[1], knee_rad = raibo().nominal_rad[2];
    const Vec3<double> before = foot_at(thigh_rad, knee_rad);
    EXPECT_LT(foot_at(thigh_rad + 0.1, knee_rad).x, before.x) << "the thigh swings backwards";
    EXPECT_GT(dot(foot_at(thigh_rad, knee_rad + 0.1), foot_at(thigh_rad, knee_rad + 0.1)),
              dot(before, before))
        << "the knee stretches";
  }
}

}  // namespace
}  // namespace sandrunner::sim
