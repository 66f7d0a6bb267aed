// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <utility>

#include "estimator/cost_of_transport.h"
#include "estimator/observation.h"
#include "rt/base/errors.h"
#include "rt/base/worker_pool.h"
#include "rt/core/command_shaping.h"
#include "sim/batch/disturbances.h"
#include "sim/lanes/random.h"
#include "sim/step/actuator.h"
#include "sim/step/divergence.h"
#include "sim/step/ground_truth.h"

namespace sandrunner::evaluate {
namespace {

enum Stream : std::uint64_t { kNoiseStream = 11, kPushStream = 12 };
constexpr std::uint64_t kDrawsPerStep = 64;

// The robots of one pack from start to end.
class PackRun {
 public:
  PackRun(const sim::Robot& robot, const sim::FootProfile<double>& foot, const Policy& policy,
          const RunnerSettings& settings, const RobotFacts& facts, const Trial* trials, int count,
          const StepObserver& observe, std::size_t first)
      : robot_(robot),
        policy_(policy),
        facts_(facts),
        trials_(trials),
        observe_(observe),
        first_(first),
        batch_(static_cast<int>(settings.width), foot, sim::StepSettings{}, settings.width),
        lanes_(static_cast<std::size_t>(count)) {
    for (int i = 0; i < count; ++i) {
      if (!sim::keeps_footprints(*trials_[i].terrain)) continue;
      prints_.resize(static_cast<std::size_t>(count));
      batch_.set_footprints(i, &prints_[static_cast<std::size_t>(i)]);
    }
    sim::RobotModel<double> model = robot.model;
    model.torque_limit_nm = facts.torque_limit_nm;
    const PolicySpec& spec = policy.spec();
    sim::BatchDrive<float> drive;
    drive.kp = static_cast<float>(spec.kp_nmprad);
    drive.kd = static_cast<float>(spec.kd_nmsprad);
    drive.heat_factor = heat_factors<float>(robot.motor_constant_nmpsqrtw);
    if (settings.torque_speed_line) drive.line = sim::drive_line<float>(robot.torque_speed_line);
    for (int i = 0; i < batch_.size(); ++i) {
      // Lanes without a trial of their own idle far above the ground.
      const Trial& trial = trials_[std::min(i, count - 1)];
      batch_.set_model(i, sim::convert_model<float>(model));
      batch_.set_terrain(i, *trial.terrain);
      batch_.set_state(i, *trial.start);
      if (i >= count) {
        park(i);
        batch_.set_drive(i, drive);
        continue;
      }
      const int late_ticks = trial.a_step_late() ? kTicksPerPolicyStep : 0;
      drive.switch_tick = static_cast<float>(trial.latency_ticks - late_ticks);
      lanes_[i].drive = drive;
      lanes_[i].target_rad = lanes_[i].answer_rad = robot.nominal_rad;
    }
  }

  void run(TrialFigures* figures) {
    int running = static_cast<int>(lanes_.size());
    for (std::uint64_t step = 0; running > 0; ++step) {
      for (std::size_t i = 0; i < lanes_.size(); ++i) {
        if (!lanes_[i].done) act(static_cast<int>(i), step);
      }
      batch_.advance(0, kTicksPerPolicyStep);
      for (std::size_t i = 0; i < lanes_.size(); ++i) {
        Lane& lane = lanes_[i];
        if (lane.done) continue;
        const sim::BatchSums<float> sums = batch_.sums(static_cast<int>(i));
        lane.recorder.end_period(sums);
        const sim::RigidState<float> x = batch_.state(static_cast<int>(i)).rigid;
        const double change_m = trials_[i].ground_changes_at_m;
        lane.met = lane.met || (change_m > 0.0 && x.position.x >= change_m);
        const bool fell = sums.base_contact > 0.0f || sums.thigh_contact > 0.0f ||
                          sim::diverged(x, trials_[i].terrain->shape);
        if (!fell && !finished(trials_[i], lane.recorder)) continue;
        figures[i] = lane.recorder.figures(trials_[i], fell, lane.met, facts_);
        lane.done = true;
        lane.recorder = {};
        park(static_cast<int>(i));
        --running;
      }
    }
  }

 private:
  struct Lane {
    bool done = false;
    NetworkState memory;
    JointArray<double> target_rad{}, answer_rad{};  // the drives', the network's
    sim::BatchDrive<float> drive;
    TrialRecorder recorder;
    sim::TouchdownWatch touchdowns;  // of the LooseStep
    bool met = false;                // the place where it is disturbed
  };

  static bool finished(const Trial& trial, const TrialRecorder& recorder) {
    if (recorder.time_s() < trial.duration_s) return false;
    if (!trial.has_track() || recorder.time_s() >= trial.longest_s) return true;
    // One period more, so that the end of the track lies inside of the record.
    return recorder.distance_m() >= trial.track_end_m + 0.1;
  }

  // In free fall far from the ground a robot costs the least; 100 km last for over two minutes.
  void park(int i) {
    sim::RobotState<float> state;
    for (int j = 0; j < kNumJoints; ++j) {
      state.rigid.q[j] = static_cast<float>(robot_.nominal_rad[j]);
    }
    state.rigid.position.z = 1e5f;
    batch_.set_state(i, state);
  }

  // One policy step of a robot.
  void act(int i, std::uint64_t step) {
    Lane& lane = lanes_[i];
    const Trial& trial = trials_[i];
    sim::RobotState<float> state = batch_.state(i);
    if (disturb(trial, step, lane, state)) batch_.set_state(i, state);
    // What is asked for, the same for every policy; and what this one is given of it.
    const VelocityCommand asked = trial.command.at(static_cast<double>(step) / kPolicyHz);
    VelocityCommand command = asked;
    command.wz_radps = shape_yaw_rate(command.wz_radps, command.vx_mps, command.vy_mps,
                                      policy_.spec().yaw_command_clip_mps2);
    const PolicyStep answer = policy_.step(observe(trial, step, command, state), lane.memory);
    // What reaches the drives in this period: this answer, or, later than that, the one before.
    const JointArray<double> target_rad = trial.a_step_late() ? lane.answer_rad : answer.target_rad;
    const StateEstimate truth = sim::ground_truth(robot_.model, state, *trial.terrain);
    if (observe_) {
      observe_(first_ + static_cast<std::size_t>(i),
               {state, truth, answer.estimate, torque_of(lane, state), lane.memory});
    }
    lane.recorder.begin_period(state, truth, answer.estimate, asked, lane.target_rad, target_rad,
                               policy_.spec().kp_nmprad, policy_.spec().kd_nmsprad, facts_);
    for (int j = 0; j < kNumJoints; ++j) {
      lane.drive.target_before[j] = static_cast<float>(lane.target_rad[j]);
      lane.drive.target[j] = static_cast<float>(target_rad[j]);
    }
    lane.target_rad = target_rad;
    lane.answer_rad = answer.target_rad;
    batch_.set_drive(i, lane.drive);
  }

  JointArray<double> torque_of(const Lane& lane, const sim::RobotState<float>& state) const {
    const sim::BatchDrive<float>& drive = lane.drive;
    JointArray<double> torque_nm{};
    for (int j = 0; j < kNumJoints; ++j) {
      torque_nm[j] = sim::drive_torque<float>(
          j, state.rigid.q[j], state.rigid.qd[j],
          {.q = static_cast<float>(lane.target_rad[j]), .kp = drive.kp, .kd = drive.kd},
          static_cast<float>(facts_.torque_limit_nm[j]), drive.line);
    }
    return torque_nm;
  }

  static std::array<float, kObservationSize> observe(const Trial& trial, std::uint64_t step,
                                                     const VelocityCommand& command,
                                                     const sim::RobotState<float>& state) {
    sim::SensorReading seen = sim::read_sensors(state.rigid, trial.sensors);
    if (trial.noise_scale > 0.0) {
      sim::add_noise(seen, {}, [&](int i, double sigma) {
        const std::uint64_t counter = step * kDrawsPerStep + static_cast<std::uint64_t>(i);
        return static_cast<float>(trial.noise_scale * sigma *
                                  sim::random_normal(trial.seed, kNoiseStream, counter));
      });
    }
    return make_observation<float>(
        {static_cast<float>(command.vx_mps), static_cast<float>(command.vy_mps),
         static_cast<float>(command.wz_radps)},
        seen.up, seen.angular_velocity, seen.position, seen.velocity);
  }

  // Pushes and the loose step. True if the state changed.
  static bool disturb(const Trial& trial, std::uint64_t step, Lane& lane,
                      sim::RobotState<float>& state) {
    bool changed = false;
    if (trial.push_speed_mps > 0.0 && step > 0 && step % kPolicyHz == 0) {
      // A direction without sine and cosine: the first of a few points that lies in the unit disc.
      double x = 1.0, y = 0.0;
      for (std::uint64_t draw = 0; draw < kDrawsPerStep; draw += 2) {
        const std::uint64_t counter = step * kDrawsPerStep + draw;
        x = 2.0 * sim::random_uniform(trial.seed, kPushStream, counter) - 1.0;
        y = 2.0 * sim::random_uniform(trial.seed, kPushStream, counter + 1) - 1.0;
        const double square = x * x + y * y;
        if (square <= 1.0 && square > 1e-4) break;
      }
      const double scale = trial.push_speed_mps / std::sqrt(x * x + y * y);
      sim::push(state, scale * x, scale * y);
      changed = true;
    }
    if (trial.loose_step.from_m > 0.0) changed = loosen(trial, lane, state) || changed;
    return changed;
  }

  // Moves the foot to the loose patch when its turn has come.
  static bool loosen(const Trial& trial, Lane& lane, sim::RobotState<float>& state) {
    const int leg = trial.loose_step.leg;
    const bool touched_down = lane.touchdowns.touched_down(state, leg);
    if (lane.met || !touched_down || lane.recorder.distance_m() < trial.loose_step.from_m) {
      return false;
    }
    sim::put_on_patch(state, leg, 1);
    lane.met = true;
    return true;
  }

  const sim::Robot& robot_;
  const Policy& policy_;
  const RobotFacts& facts_;
  const Trial* trials_;
  const StepObserver& observe_;
  std::size_t first_;  // place of this pack's first trial among all
  sim::Batch batch_;
  std::vector<Lane> lanes_;
  std::vector<sim::Footprints> prints_;  // of the lanes, where one keeps them
};

}  // namespace

RobotFacts robot_facts(const sim::Robot& robot, const PolicySpec& policy) {
  RobotFacts facts;
  facts.mass_kg = robot.model.mass();
  facts.torque_limit_nm = robot.model.torque_limit_nm;
  facts.motor_constant = robot.motor_constant_nmpsqrtw[0];
  if (policy.torque_limit_nm > 0.0) {
    for (double& limit : facts.torque_limit_nm) limit = std::min(limit, policy.torque_limit_nm);
  }
  const auto foot = [&](int l) {
    const JointArray<double>& q = robot.nominal_rad;
    const sim::LegModel<double>& leg = robot.model.legs[l];
    const auto pose = sim::leg_pose<double>(leg, q[3 * l], q[3 * l + 1], q[3 * l + 2]);
    return sim::hip_to_base(leg, pose, pose.foot);
  };
  const sim::Vec3<double> diagonal = foot(0) - foot(3);
  facts.foot_diagonal_m = std::sqrt(dot(diagonal, diagonal));
  return facts;
}

std::vector<TrialFigures> run_trials(const sim::Robot& robot, const sim::FootProfile<double>& foot,
                                     const Policy& policy, const std::vector<Trial>& trials,
                                     const RunnerSettings& settings,
                                     const std::function<void(std::size_t)>& progress,
                                     const StepObserver& observe) {
  const auto width = static_cast<std::size_t>(settings.width);
  const RobotFacts facts = robot_facts(robot, policy.spec());
  std::vector<TrialFigures> figures(trials.size());
  WorkerPool pool(settings.threads);
  std::size_t done = 0;
  std::mutex mutex;  // of `done` and the call of `progress`
  pool.run(static_cast<int>((trials.size() + width - 1) / width), [&](int pack, int) {
    const std::size_t first = static_cast<std::size_t>(pack) * width;
    const std::size_t count = std::min(width, trials.size() - first);
    PackRun(robot, foot, policy, settings, facts, trials.data() + first, static_cast<int>(count),
            observe, first)
        .run(figures.data() + first);
    const std::lock_guard lock(mutex);
    done += count;
    if (progress) progress(done);
  });
  return figures;
}

}  // namespace sandrunner::evaluate
