// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <thread>

#include "rt/base/processor_name.h"
#include "rt/core/processor.h"
#include "tools/bench/benches.h"
#include "tools/bench/clock.h"
#include "tools/bench/standing_mujoco.h"
#include "tools/bench/trotting_robots.h"

namespace sandrunner::bench {
namespace {

constexpr int kRobots = 256;
// About a tenth of a second each.
constexpr int kBatchPeriods = 40;
constexpr int kDoublePeriods = 1000;
constexpr int kMujocoSteps = 6000;
constexpr int kWarmUpPeriods = 100;

// Steps per second of all packs on one or two threads, by the clock on the wall.
double wall_rate(TrottingBatch& robots, int threads) {
  const double start_s = clock_s(CLOCK_MONOTONIC);
  const int middle = threads == 2 ? robots.packs() / 2 : robots.packs();
  std::thread other([&] {
    flush_denormals_to_zero();
    robots.advance(middle, robots.packs(), kBatchPeriods);
  });
  robots.advance(0, middle, kBatchPeriods);
  other.join();
  return robots.size() * kBatchPeriods * kTicksPerPolicyStep / (clock_s(CLOCK_MONOTONIC) - start_s);
}

void require_walking(const TrottingBatch& robots) {
  if (const int fallen = robots.fallen(); fallen > 0) {
    throw std::runtime_error(fmt::format("{} of {} trotting robots fell", fallen, robots.size()));
  }
}

}  // namespace

Report run_batch_bench(int rounds) {
  flush_denormals_to_zero();
  const sim::Robot robot = sim::load_raibo();
  StandingMujoco mujoco(robot, MujocoSolver::kDefault);
  StandingMujoco mujoco_fastest(robot, MujocoSolver::kFastest);
  TrottingRobot one(robot);
  TrottingBatch x8(robot, kRobots, sim::BatchWidth::kEight);
  std::unique_ptr<TrottingBatch> x16;
  if (sim::best_batch_width() == sim::BatchWidth::kSixteen) {
    x16 = std::make_unique<TrottingBatch>(robot, kRobots, sim::BatchWidth::kSixteen);
  }
  TrottingBatch& widest = x16 ? *x16 : x8;

  // Out of the transients of the start.
  mujoco.advance(kMujocoSteps);
  mujoco_fastest.advance(kMujocoSteps);
  one.advance(kWarmUpPeriods);
  x8.advance(0, x8.packs(), kWarmUpPeriods);
  if (x16) x16->advance(0, x16->packs(), kWarmUpPeriods);

  Samples rates;
  double contacts = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const auto batch_rate = [](TrottingBatch& robots) {
      const double s = cpu_time_s([&] { robots.advance(0, robots.packs(), kBatchPeriods); });
      return robots.size() * kBatchPeriods * kTicksPerPolicyStep / s;
    };
    rates["mujoco"].push_back(kMujocoSteps / cpu_time_s([&] { mujoco.advance(kMujocoSteps); }));
    if (x16) rates["batch_x16"].push_back(batch_rate(*x16));
    rates["batch_x8"].push_back(batch_rate(x8));
    rates["one_robot_double"].push_back(kDoublePeriods * kTicksPerPolicyStep /
                                        cpu_time_s([&] { one.advance(kDoublePeriods); }));
    rates["mujoco_fastest"].push_back(kMujocoSteps /
                                      cpu_time_s([&] { mujoco_fastest.advance(kMujocoSteps); }));
    rates["one_thread_wall"].push_back(wall_rate(widest, 1));
    rates["two_threads_wall"].push_back(wall_rate(widest, 2));
    contacts += x8.mean_contacts() / rounds;
  }
  require_walking(x8);
  if (x16) require_walking(*x16);
  if (one.fallen()) throw std::runtime_error("the trotting robot in double fell");
  if (mujoco.height_m() < kFallenHeight_m || std::fabs(mujoco.mean_contacts() - 4.0) > 0.05) {
    throw std::runtime_error(fmt::format("MuJoCo's robot: {:.2f} contacts, height {:.2f} m",
                                         mujoco.mean_contacts(), mujoco.height_m()));
  }

  Report report;
  report.facts = {
      {"processor", processor_name()},
      {"ours",
       fmt::format(
           "{} robots trotting at {} Hz on dry sand, {:.2f} feet on the ground, 0.25 ms, "
           "torque-speed line, delay; one core, float in {} lanes and in 8; one robot in double",
           kRobots, kTrotHz, contacts, widest.size() / widest.packs())},
      {"mujoco", mujoco.description()},
      {"fastest", mujoco_fastest.description()},
      {"clock", "processor time of the thread; wall clock for one and two threads"}};
  for (const auto& [name, values] : rates) report.rates.emplace_back(name, quartiles(values));
  const auto ratio = [&](const char* name, const char* above, const char* below) {
    add_ratio(report, name, rates, above, below);
  };
  ratio("batch_x16_vs_mujoco", "batch_x16", "mujoco");
  ratio("batch_x8_vs_mujoco", "batch_x8", "mujoco");
  ratio("one_robot_double_vs_mujoco", "one_robot_double", "mujoco");
  ratio("two_threads_vs_one", "two_threads_wall", "one_thread_wall");
  ratio("mujoco_fastest_vs_mujoco", "mujoco_fastest", "mujoco");
  return report;
}

}  // namespace sandrunner::bench
