// SPDX-License-Identifier: BSD-3-Clause
// The contact solver on problems from a trotting robot: against the paper's own iteration run to
// 1e-10 N s, and against what defines a solution.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

using std::numbers::pi;

/// A contact problem as a step of the robot left it, solved.
struct Problem {
  std::array<PointContact<double>, kMaxPoints> points;
  int num_points = 0;
  int sweeps = 0;
  /// At most one point a leg and none on the base: then the impulses are unique, and comparable.
  bool only_feet() const {
    std::array<int, kNumLegs> count{};
    for (int i = 0; i < num_points; ++i) {
      if (points[i].leg < 0 || ++count[points[i].leg] > 1) return false;
    }
    return true;
  }
};

/// PD torques of an open-loop trot with random stride; the robot moves, slips, and sometimes falls.
class Trot {
 public:
  explicit Trot(Draw& draw)
      : phase_(draw(0.0, 2.0 * pi)),
        rate_(2.0 * pi * draw(2.0, 4.0)),
        stride_(draw(0.1, 0.4)),
        sway_(draw(0.0, 0.2)) {}
  std::array<double, kNumJoints> torque(const Bench& bench, double t) const {
    std::array<double, kNumJoints> torque;
    for (int l = 0; l < kNumLegs; ++l) {
      const double phase = phase_ + rate_ * t + (l == 0 || l == 3 ? 0.0 : pi);
      const double lift = 0.5 * std::fmax(std::sin(phase), 0.0);
      const double offset[3] = {sway_ * std::sin(phase), stride_ * std::cos(phase) + lift,
                                -2.0 * lift};
      for (int j = 3 * l; j < 3 * l + 3; ++j) {
        const double target = bench.robot.nominal_rad[j] + offset[j % 3];
        const double wanted =
            120.0 * (target - bench.state.rigid.q[j]) - 2.0 * bench.state.rigid.qd[j];
        torque[j] = std::clamp(wanted, -63.45, 63.45);
      }
    }
    return torque;
  }

 private:
  double phase_, rate_, stride_, sway_;
};

std::vector<Problem> harvest(GroundKind kind, double tolerance_ns) {
  std::vector<Problem> problems;
  Draw draw(kind == GroundKind::kRigid ? 1 : 2);
  for (int run = 0; run < 10; ++run) {
    Bench bench(ground_of_kind(kind));
    bench.settings.tolerance_ns = tolerance_ns;
    bench.state.rigid.velocity = {draw(-1.0, 1.0), draw(-0.5, 0.5), 0.0};
    bench.state.rigid.position.z += 0.002;
    const Trot trot(draw);
    for (int i = 0; i < 2000; ++i) {
      bench.step(trot.torque(bench, i * bench.settings.dt_s));
      // Stops are rows of the same problem that points() does not show.
      const auto& stops = bench.state.stop_impulse;
      if (std::any_of(stops.begin(), stops.end(), [](double s) { return s != 0.0; })) continue;
      if (bench.stepper.num_points() == 0) continue;
      problems.push_back({bench.stepper.points(), bench.stepper.num_points(), bench.report.sweeps});
    }
  }
  return problems;
}

ImpulseSum<double> effect_of(const Problem& p) {
  ImpulseSum<double> sum;
  for (int i = 0; i < p.num_points; ++i) {
    const PointContact<double>& c = p.points[i];
    for (int r = 0; r < 3; ++r) add_impulse(c.w[r], c.j[r], c.leg, c.impulse[r], sum);
  }
  return sum;
}

/// How far a problem's impulses are from what defines a solution, in m/s.
struct Violation {
  double opening = 0.0;   ///< hard: -v_n, or |v_n| under an impulse
  double sticking = 0.0;  ///< speed although the friction disc is not reached
  double sliding = 0.0;   ///< part of the slip that does not oppose the impulse
  double disc = 0.0;      ///< tangential impulse beyond the disc, N s
};
Violation violation(const Problem& p) {
  Violation worst;
  const ImpulseSum<double> sum = effect_of(p);
  for (int i = 0; i < p.num_points; ++i) {
    const PointContact<double>& c = p.points[i];
    double v[3];
    for (int r = 0; r < 3; ++r) v[r] = row_velocity(c.w[r], c.p[r], c.leg, c.free[r], sum);
    if (c.hard) {
      EXPECT_GE(c.impulse[2], 0.0);
      worst.opening = std::fmax(worst.opening, c.impulse[2] > 0.0 ? std::fabs(v[2]) : -v[2]);
    }
    const double disc = c.hard ? c.friction * c.impulse[2] : c.disc;
    const double t = std::hypot(c.impulse[0], c.impulse[1]), speed = std::hypot(v[0], v[1]);
    worst.disc = std::fmax(worst.disc, t - disc);
    if (t < disc * (1.0 - 1e-6)) {
      worst.sticking = std::fmax(worst.sticking, speed);
    } else if (t > 1e-9) {
      const double along =
          (v[0] * c.impulse[0] + v[1] * c.impulse[1]) / t;  // -speed, were it opposed
      worst.sliding = std::fmax(worst.sliding, speed + along);
    }
  }
  return worst;
}

/// The paper's iteration (algorithm S1; constants of the authors' code): one projected gradient
/// step per visit, started without impulses. Returns the number of sweeps, at most `max_sweeps`.
int solve_by_projection(std::array<PointContact<double>, kMaxPoints>& points, int num_points,
                        double tolerance_ns, int max_sweeps) {
  ImpulseSum<double> sum;
  for (int i = 0; i < num_points; ++i) {
    PointContact<double>& c = points[i];
    c.impulse = {0.0, 0.0, c.hard ? 0.0 : c.impulse[2]};
    if (c.active) add_impulse(c.w[2], c.j[2], c.leg, c.impulse[2], sum);
  }
  for (int sweep = 1; sweep <= max_sweeps; ++sweep) {
    double change = 0.0;
    for (int i = 0; i < num_points; ++i) {
      PointContact<double>& c = points[i];
      if (!c.active) continue;
      double v[3];
      for (int r = 0; r < 3; ++r) v[r] = row_velocity(c.w[r], c.p[r], c.leg, c.free[r], sum);
      const std::array<double, 3> next = projected_step(c, c.hard, v[0], v[1], v[2]);
      for (int r = 0; r < 3; ++r) add_impulse(c.w[r], c.j[r], c.leg, next[r] - c.impulse[r], sum);
      change += std::fabs(next[2] - c.impulse[2]) +
                std::hypot(next[0] - c.impulse[0], next[1] - c.impulse[1]);
      c.impulse = next;
    }
    if (change < tolerance_ns) return sweep;
  }
  return max_sweeps;
}

class ContactSolverTest : public testing::TestWithParam<GroundKind> {};

TEST_P(ContactSolverTest, AgreesWithThePapersIteration) {
  const std::vector<Problem> problems = harvest(GetParam(), 1e-5);
  double worst_ns = 0.0, sweeps = 0.0, paper_sweeps = 0.0;
  int compared = 0;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Problem& p = problems[i];
    sweeps += p.sweeps;
    if (i % 5 != 0 || !p.only_feet()) continue;
    auto points = p.points;
    const int n = solve_by_projection(points, p.num_points, 1e-10, 100000);
    EXPECT_LT(n, 100000);
    double difference_ns = 0.0;
    for (int k = 0; k < p.num_points; ++k) {
      const auto &a = points[k].impulse, &b = p.points[k].impulse;
      difference_ns += std::hypot(a[0] - b[0], a[1] - b[1]) + std::fabs(a[2] - b[2]);
    }
    worst_ns = std::fmax(worst_ns, difference_ns);
    points = p.points;
    paper_sweeps += solve_by_projection(points, p.num_points, 1e-5, 150);
    ++compared;
  }
  EXPECT_GT(compared, 1500);
  EXPECT_LT(worst_ns, 1e-5);
  EXPECT_LT(sweeps / static_cast<double>(problems.size()), 4.0);
  RecordProperty("figures",
                 testing::PrintToString(std::vector<double>{
                     static_cast<double>(compared), worst_ns,
                     sweeps / static_cast<double>(problems.size()), paper_sweeps / compared}));
}

TEST_P(ContactSolverTest, ImpulsesMeetTheContactConditions) {
  int checked = 0;
  Violation worst;
  for (const Problem& p : harvest(GetParam(), 1e-8)) {
    if (!p.only_feet()) continue;
    const Violation v = violation(p);
    worst.opening = std::fmax(worst.opening, v.opening);
    worst.sticking = std::fmax(worst.sticking, v.sticking);
    worst.sliding = std::fmax(worst.sliding, v.sliding);
    worst.disc = std::fmax(worst.disc, v.disc);
    ++checked;
  }
  EXPECT_GT(checked, 9000);
  // 1e-8 N s and 5 /kg, the largest inverse apparent mass of a foot.
  EXPECT_LT(worst.opening, 1e-6);
  EXPECT_LT(worst.sticking, 1e-6);
  EXPECT_LT(worst.sliding, 1e-6);
  EXPECT_LT(worst.disc, 1e-12);
  RecordProperty("worst", testing::PrintToString(std::vector<double>{worst.opening, worst.sticking,
                                                                     worst.sliding, worst.disc}));
}

TEST_P(ContactSolverTest, ImpulsesMeetTheConditionsWithKneesAndBaseOnTheGround) {
  int checked = 0, unfinished = 0;
  Violation worst;
  for (const Problem& p : harvest(GetParam(), 1e-5)) {
    if (p.only_feet()) continue;
    ++checked;
    unfinished += p.sweeps >= StepSettings{}.max_sweeps;
    const Violation v = violation(p);
    worst.opening = std::fmax(worst.opening, v.opening);
    worst.disc = std::fmax(worst.disc, v.disc);
  }
  EXPECT_GT(checked, 100);
  // A foot in sand and the hard knee of the same leg can keep the sweeps from settling; it must
  // stay rare.
  EXPECT_LT(unfinished, 0.03 * checked);
  EXPECT_LT(worst.opening, 5e-3);
  EXPECT_LT(worst.disc, 1e-12);
  RecordProperty("worst", testing::PrintToString(std::vector<double>{
                              static_cast<double>(checked), static_cast<double>(unfinished),
                              worst.opening, worst.disc}));
}

INSTANTIATE_TEST_SUITE_P(Grounds, ContactSolverTest,
                         testing::Values(GroundKind::kGranular, GroundKind::kRigid,
                                         GroundKind::kLinear, GroundKind::kMud),
                         [](const auto& kind) { return std::string(kind_name(kind.param)); });

TEST(HardContactTest, OneFootStopsAtAnyVelocity) {
  // One hard foot of a trotting robot, hit from anywhere: sticking, sliding and jamming (friction
  // that presses the leg in) all have a solution.
  std::array<StopRow<double>, kNumJoints> no_stops;
  Draw draw(7);
  double worst = 0.0;
  int checked = 0, slid = 0;
  for (const Problem& p : harvest(GroundKind::kRigid, 1e-5)) {
    Problem one;
    one.points[0] = p.points[0];
    one.num_points = 1;
    PointContact<double>& c = one.points[0];
    c.friction = draw(0.2, 1.2);
    for (double& v : c.free) v = draw(-1.0, 1.0);
    c.impulse = {0.0, 0.0, 0.0};
    ImpulseSum<double> sum;
    solve_contacts<double, kMaxPoints, kNumJoints>(one.points, 1, no_stops, 0, 1e-9, 1000, sum);
    const Violation v = violation(one);
    worst = std::max({worst, v.opening, v.sticking, v.sliding});
    EXPECT_LT(v.disc, 1e-12);
    slid += c.impulse[2] > 0.0 &&
            std::hypot(c.impulse[0], c.impulse[1]) > 0.999999 * c.friction * c.impulse[2];
    ++checked;
  }
  EXPECT_GT(slid, checked / 10);
  EXPECT_LT(slid, checked / 2);
  EXPECT_LT(worst, 1e-5);
}

TEST(SolveOnDiscTest, MatchesBruteForce) {
  // Over the conditions that feet show (largest over smallest eigenvalue up to 2.3), and somewhat
  // more.
  Draw draw(3);
  int slid = 0;
  for (int n = 0; n < 5000; ++n) {
    const double large = draw(0.5, 5.0), small = large / draw(1.0, 4.0), turn = draw(0.0, pi);
    const double c = std::cos(turn), s = std::sin(turn);
    const double gxx = large * c * c + small * s * s, gyy = large * s * s + small * c * c,
                 gxy = (large - small) * c * s;
    const double size = std::pow(10.0, draw(-4.0, 1.0)), angle = draw(0.0, 2.0 * pi);
    const double bx = size * std::cos(angle), by = size * std::sin(angle),
                 radius = std::pow(10.0, draw(-5.0, 0.0));
    double tx, ty;
    solve_on_disc(gxx, gxy, gyy, bx, by, radius, tx, ty);
    const auto energy = [&](double x, double y) {
      return 0.5 * (gxx * x * x + 2.0 * gxy * x * y + gyy * y * y) + bx * x + by * y;
    };
    ASSERT_LE(std::hypot(tx, ty), radius * (1.0 + 1e-12));
    // The rim by a golden-section search from the best of 64 directions; the inside by the
    // unconstrained minimum.
    const double det = gxx * gyy - gxy * gxy;
    double best_x = (gxy * by - gyy * bx) / det, best_y = (gxy * bx - gxx * by) / det;
    if (std::hypot(best_x, best_y) > radius) {
      ++slid;
      double best = 0.0;
      for (int i = 1; i < 64; ++i) {
        const auto at = [&](int k) {
          return energy(radius * std::cos(k * pi / 32), radius * std::sin(k * pi / 32));
        };
        if (at(i) < at(static_cast<int>(best))) best = i;
      }
      double low = (best - 1.0) * pi / 32, high = (best + 1.0) * pi / 32;
      const auto rim = [&](double a) { return energy(radius * std::cos(a), radius * std::sin(a)); };
      for (int i = 0; i < 60; ++i) {
        const double a = low + 0.381966 * (high - low), b = low + 0.618034 * (high - low);
        (rim(a) < rim(b) ? high : low) = rim(a) < rim(b) ? b : a;
      }
      best_x = radius * std::cos(low);
      best_y = radius * std::sin(low);
    }
    // The search sees the energy, which is flat at its minimum: half the digits.
    ASSERT_NEAR(tx, best_x, 2e-6 * (radius + std::fabs(best_x)));
    ASSERT_NEAR(ty, best_y, 2e-6 * (radius + std::fabs(best_y)));
  }
  EXPECT_GT(slid, 1000);
}

}  // namespace
}  // namespace sandrunner::sim
