// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-train: trains a policy from random weights on randomised deformable ground.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

#include "policy/policy_file.h"
#include "rt/base/build.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "tools/train/embedded.h"
#include "tools/train/progress.h"
#include "tools/train/task/task.h"

namespace {

using namespace sandrunner;
using namespace sandrunner::train;

std::atomic<bool> interrupted{false};

struct Arguments {
  std::string out, config_file;
  std::vector<std::string> assignments;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::uint64_t seed = 1;
  bool resume = false;
};

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

// What a checkpoint belongs to: another configuration or seed would not continue to the same
// weights.
std::uint64_t config_hash(const std::string& text, std::uint64_t seed) {
  std::uint64_t h = 14695981039346656037u ^ seed;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return h;
}

// One training: everything that continues from checkpoint to checkpoint.
class Training {
 public:
  Training(const TrainConfig& config, const Arguments& arguments)
      : config_(config),
        arguments_(arguments),
        pool_(arguments.threads),
        task_(config, arguments.seed),
        learner_(config.learner, {config.run.envs, config.window, task_.privileged_size()},
                 arguments.seed, pool_, Task::symmetry()),
        checkpoint_path_(arguments.out + "/checkpoint.bin"),
        config_hash_(config_hash(config.effective, arguments.seed)),
        builds_(build_commit()),
        processors_(processor_name()) {}

  void start() {
    pool_.run(learner_.blocks(),
              [&](int block, int) { task_.observe(block, 0, learner_.rollout()); });
  }

  void resume() {
    const learner::Checkpoint checkpoint = learner::load_checkpoint(checkpoint_path_);
    if (checkpoint.config_hash != config_hash_) {
      throw InputError(
          fmt::format("{}: was made with another config or seed; continue with the same ones",
                      checkpoint_path_));
    }
    restore(checkpoint);
    checkpoint.get("run.cpu_seconds", &cpu_before_, 1);
    // Everyone who had a hand in the weights.
    for (const auto& [section, now] :
         {std::pair{"run.builds", &builds_}, std::pair{"run.processors", &processors_}}) {
      Names names{};
      checkpoint.get(section, names.data(), names.size());
      const std::string before = names.data();
      const bool known = (", " + before + ", ").find(", " + *now + ", ") != std::string::npos;
      *now = known ? before : before + ", " + *now;
    }
  }

  void save() {
    learner::Checkpoint checkpoint;
    learner_.save(checkpoint);
    task_.save(checkpoint);
    progress_.save(checkpoint);
    const double cpu = cpu_before_ + cpu_seconds();
    checkpoint.put("run.cpu_seconds", &cpu, 1);
    for (const auto& [section, text] :
         {std::pair{"run.builds", &builds_}, std::pair{"run.processors", &processors_}}) {
      Names names{};
      text->copy(names.data(), names.size() - 1);
      checkpoint.put(section, names.data(), names.size());
    }
    // The first observation of the next window was made with noise that is not drawn again.
    const learner::Rollout& rollout = learner_.rollout();
    checkpoint.put("run.observation", rollout.observation(0).data(),
                   static_cast<std::size_t>(rollout.observation(0).size()));
    checkpoint.put("run.privileged", rollout.privileged(0).data(),
                   static_cast<std::size_t>(rollout.privileged(0).size()));
    checkpoint.put("run.target", rollout.estimate_target(0).data(),
                   static_cast<std::size_t>(rollout.estimate_target(0).size()));
    checkpoint.config_hash = config_hash_;
    learner::save_checkpoint(checkpoint, checkpoint_path_);
    write_policy_file(arguments_.out + "/policy.safetensors", policy_file());
    progress_.write(arguments_.out);
    saved_wall_ = wall_seconds();
    fallbacks_ = 0;
  }

  // Windows until the transitions are done or somebody interrupts.
  void run() {
    saved_wall_ = wall_seconds();
    const double start_wall = wall_seconds();
    const auto start_transitions = static_cast<double>(learner_.transitions());
    while (static_cast<double>(learner_.transitions()) < config_.run.transitions && !interrupted) {
      const double t0 = wall_seconds();
      pool_.run(learner_.blocks(), [&](int block, int worker) {
        for (int t = 0; t < config_.window; ++t) {
          learner_.act_block(block, t, worker);
          task_.step(block, t, learner_, worker);
        }
      });
      const double t1 = wall_seconds();
      learner_.set_kl_target(kl_target());
      learner_.set_symmetry_weight(config_.learner.loss.symmetry_weight * task_.late());
      const learner::UpdateStats update = learner_.update();
      const double t2 = wall_seconds();
      if (!update.finite) {
        fall_back();
        continue;
      }
      const auto done = static_cast<double>(learner_.transitions());
      const WindowStats window = task_.end_window(done);
      const ProgressRow row = make_row(window, update, t1 - t0, t2 - t0);
      progress_.add(row);
      const double rate = (done - start_transitions) / (t2 - start_wall);
      if (learner_.updates() % 10 == 1 || done >= config_.run.transitions) {
        fmt::print("{}\n", Progress::line(row, (config_.run.transitions - done) / rate));
        std::fflush(stdout);
      }
      if (t2 - saved_wall_ > config_.run.checkpoint_interval_s) save();
    }
    // A training that was complete stays as it is.
    if (static_cast<double>(learner_.transitions()) > start_transitions) save();
  }

 private:
  using Names = std::array<char, 1024>;

  void restore(const learner::Checkpoint& checkpoint) {
    learner_.load(checkpoint);
    task_.load(checkpoint);
    progress_.load(checkpoint);
    learner::Rollout& rollout = learner_.rollout();
    checkpoint.get("run.observation", rollout.observation(0).data(),
                   static_cast<std::size_t>(rollout.observation(0).size()));
    checkpoint.get("run.privileged", rollout.privileged(0).data(),
                   static_cast<std::size_t>(rollout.privileged(0).size()));
    checkpoint.get("run.target", rollout.estimate_target(0).data(),
                   static_cast<std::size_t>(rollout.estimate_target(0).size()));
  }

  // Smaller and smaller updates in the last part: the policy settles.
  double kl_target() const {
    const RunSettings& run = config_.run;
    const double left = (run.transitions - static_cast<double>(learner_.transitions())) /
                        std::max(run.transitions * run.settle_share, 1.0);
    const double start = config_.learner.kl_target;
    return std::clamp(left, run.settle_kl_share, 1.0) * start;
  }

  void fall_back() {
    if (!std::filesystem::exists(checkpoint_path_)) {
      throw std::runtime_error("an update is not finite, before the first checkpoint");
    }
    if (++fallbacks_ > 5) {
      throw std::runtime_error(
          fmt::format("no finite update from {} on, with smaller and smaller learning rates",
                      checkpoint_path_));
    }
    to_standard_error(fmt::format("update {} is not finite: back to {}, slower\n",
                                  learner_.updates(), checkpoint_path_));
    restore(learner::load_checkpoint(checkpoint_path_));
    // The same steps would end in the same bits.
    for (int i = 0; i < fallbacks_; ++i) learner_.halve_learning_rate();
  }

  ProgressRow make_row(const WindowStats& w, const learner::UpdateStats& u, double simulation_s,
                       double total_s) const {
    ProgressRow r;
    const auto& deviation = task_.scales().estimate_deviation;
    r.iteration = static_cast<double>(learner_.updates());
    r.transitions = static_cast<double>(learner_.transitions());
    r.core_hours = (cpu_before_ + cpu_seconds()) / 3600.0;
    r.transitions_per_s = config_.run.envs * config_.window / total_s;
    r.simulation_share = simulation_s / total_s;
    r.reward = w.reward;
    r.kernel_rigid = w.kernel[0];
    r.kernel_soil = w.kernel[1];
    r.falls_rigid = w.falls[0];
    r.falls_soil = w.falls[1];
    r.speed_ratio_rigid = w.speed_ratio[0];
    r.speed_ratio_soil = w.speed_ratio[1];
    r.estimate_vx_rms_mps = u.estimate_rms[1] * static_cast<double>(deviation[1]);
    r.estimate_height_rms_m = u.estimate_rms[0] * static_cast<double>(deviation[0]);
    r.command_speed_mps = task_.curriculum().speed_mps;
    r.ground_open = task_.curriculum().ground;
    r.body_height_m = w.body_height_m;
    r.torque_squared = w.torque_squared;
    r.power_w = w.power_w;
    r.stride_hz = w.stride_hz;
    r.abreast = w.abreast;
    r.diagonal = w.diagonal;
    r.learning_rate = u.learning_rate;
    r.kl = u.kl;
    r.action_std = u.action_std;
    r.asymmetry = u.asymmetry;
    r.explained_variance = u.explained_variance;
    return r;
  }

  PolicyFile policy_file() const {
    PolicyFile file;
    PolicySpec& spec = file.spec;
    spec.name = "raibo";
    spec.nominal_position_rad = task_.nominal_rad();
    spec.action_scale_rad = config_.policy.action_scale_rad;
    spec.action_clip = config_.policy.action_clip;
    spec.kp_nmprad = config_.policy.kp_nmprad;
    spec.kd_nmsprad = config_.policy.kd_nmsprad;
    spec.torque_limit_nm = 63.45;
    spec.yaw_command_clip_mps2 = config_.command.centripetal_mps2;
    const InputScales& scales = task_.scales();
    for (int i = 0; i < kEstimateSize; ++i) {
      spec.estimate_mean[i] = scales.estimate_mean[i];
      spec.estimate_variance[i] = scales.estimate_deviation[i] * scales.estimate_deviation[i];
    }
    spec.joint_names = sim::load_raibo().description.joint_names;
    spec.provenance = {
        {"config", config_.effective},
        {"seed", std::to_string(arguments_.seed)},
        {"threads", std::to_string(arguments_.threads)},
        {"transitions", std::to_string(learner_.transitions())},
        {"core_hours", fmt::format("{:.3f}", (cpu_before_ + cpu_seconds()) / 3600.0)},
        {"processor", processors_},
        {"commit", builds_},
        {"origin", "sandrunner-train, from random weights"}};
    NetworkParameters& p = file.parameters;
    p.observation_clip = scales.clip;
    p.observation_mean.assign(scales.mean.begin(), scales.mean.end());
    for (const float d : scales.inverse_deviation) {
      p.observation_variance.push_back(1.0f / (d * d) - 1e-8f);  // the network adds 1e-8
    }
    auto tensors = learner::policy_tensors(learner_.layout(), learner_.averaged());
    for (const NamedTensor& to : tensors_of(p)) {
      for (auto& from : tensors) {
        if (from.name == to.name) *to.values = from.values;
      }
    }
    file.golden = make_golden_example(p);
    return file;
  }

  TrainConfig config_;
  Arguments arguments_;
  learner::WorkerPool pool_;
  Task task_;
  learner::Learner learner_;
  Progress progress_;
  std::string checkpoint_path_;
  std::uint64_t config_hash_;
  std::string builds_, processors_;  // of this process and those it continues, separated by commas
  double cpu_before_ = 0.0;          // core time of those before
  double saved_wall_ = 0.0;
  int fallbacks_ = 0;
};

int run(int argc, char** argv) {
  Arguments a;
  CLI::App app{"Trains a policy from random weights on randomised deformable ground."};
  app.add_option("--out", a.out,
                 "folder for checkpoint.bin, policy.safetensors, curve.csv, curve.png")
      ->required()
      ->type_name("DIR");
  app.add_option("--config", a.config_file,
                 "TOML with settings that differ from the built-in raibo.toml")
      ->type_name("FILE");
  app.add_option("--set", a.assignments, "one setting; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  app.add_option("--threads", a.threads, "worker threads")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--seed", a.seed, "of weights and environments")->capture_default_str();
  app.add_flag("--resume", a.resume, "continue from the checkpoint in --out");
  app.set_version_flag("--version", std::string("sandrunner-train ") + SANDRUNNER_VERSION);
  if (!parse_command_line(app, argc, argv)) return kExitOk;
  ConfigTree tree;
  tree.add_text(embedded_train_file("raibo.toml"), "raibo.toml");
  if (!a.config_file.empty()) tree.add_file(a.config_file);
  for (const std::string& assignment : a.assignments) tree.set(assignment);
  const TrainConfig config = read_train_config(tree);
  if (!a.resume && std::filesystem::exists(a.out + "/checkpoint.bin")) {
    throw InputError(
        fmt::format("--out: '{}' holds a training; give --resume or another folder", a.out));
  }
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  Training training(config, a);
  if (a.resume) training.resume();
  prepare_folder(a.out, "--out");
  if (!a.resume) training.start();
  training.run();
  return kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-train", [&] { return run(argc, argv); });
}
