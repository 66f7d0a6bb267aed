// SPDX-License-Identifier: BSD-3-Clause
// The same bits from every compiler: a quarter of a second of flailing on every kind of ground,
// hashed.
//
// The constants were the same from g++ 12 and clang++ 14, at -O2 and -O3. A change of the
// simulator's arithmetic moves them: check that both compilers agree on the new values, and put
// those here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "rt/core/state_hash.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

std::string hex(std::uint64_t value) { return fmt::format("{:#x}", value); }

template <typename S>
std::uint64_t run_hash(const GroundParameters& ground, const ShapeParameters& shape) {
  const Bench bench(ground, load_raibo(), shape);
  const RobotModel<S> model = convert_model<S>(bench.robot.model);
  const FootProfile<S> foot = convert_profile<S>(bench.foot);
  const Terrain<S> terrain = convert_terrain<S>(bench.terrain);
  RobotState<S> state;
  state.rigid = convert<S>(bench.state.rigid);
  state.rigid.velocity = {S(1.0), S(0.25), S(-0.5)};
  RobotStepper<S> stepper;
  StepReport<S> report;
  StateHash hash;
  Draw draw(11);
  std::array<S, kNumJoints> target{};
  for (int i = 0; i < 1000; ++i) {
    if (i % 40 == 0) {
      for (int j = 0; j < kNumJoints; ++j)
        target[j] = S(bench.robot.nominal_rad[j] + draw(-0.5, 0.5));
    }
    std::array<S, kNumJoints> torque;
    for (int j = 0; j < kNumJoints; ++j) {
      torque[j] = fma(S(60.0), target[j] - state.rigid.q[j], -state.rigid.qd[j]);
    }
    stepper.step(model, foot, terrain, {}, torque, state, report);
    for (const S q : state.rigid.q) hash.add(static_cast<double>(q));
    hash.add(static_cast<double>(state.rigid.position.x));
    hash.add(static_cast<double>(state.rigid.position.z));
    hash.add(static_cast<double>(state.rigid.orientation.w));
    for (const auto& f : report.foot_force) hash.add(static_cast<double>(f[2]));
  }
  return hash.value();
}

TEST(HashTest, StepGivesTheSameBitsFromEveryCompiler) {
  const struct {
    const char* name;
    GroundKind kind;
    ShapeParameters shape;
    std::uint64_t in_double, in_float;
  } cases[] = {{"granular", GroundKind::kGranular, {}, 0x2ce81579ee5addf3u, 0xab9736ec7c9d6208u},
               {"rigid", GroundKind::kRigid, {}, 0x815d2f53af6042a9u, 0x7aac69b0b483fb46u},
               {"rough", GroundKind::kRigid, waves(0.01), 0x5a9333669cf1d985u, 0x15d99ea763e34a9eu},
               {"linear", GroundKind::kLinear, {}, 0xc4784dd71e32ea54u, 0x97b580609ffdd6f5u},
               {"mud", GroundKind::kMud, {}, 0x4021c4f6676249cfu, 0xe24cd4517d0a321eu}};
  for (const auto& c : cases) {
    EXPECT_EQ(hex(run_hash<double>(ground_of_kind(c.kind), c.shape)), hex(c.in_double)) << c.name;
    EXPECT_EQ(hex(run_hash<float>(ground_of_kind(c.kind), c.shape)), hex(c.in_float)) << c.name;
  }
}

TEST(HashTest, FootProfileGivesTheSameBitsFromEveryCompiler) {
  StateHash hash;
  for (const FootShape shape : {FootShape::kTyre, FootShape::kSphere}) {
    const FootProfile<double> foot = fit_foot_profile(shape, 0.0295, 0.025, 4.0);
    hash.add(foot.p0);
    hash.add(foot.p1);
  }
  EXPECT_EQ(hex(hash.value()), hex(0x648bb90c74fcab89u));
}

}  // namespace
}  // namespace sandrunner::sim
