// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/models.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <tuple>
#include <utility>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/core/state_hash.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

constexpr const char* kExpected = "NAME-SEED.safetensors, such as ours-1.safetensors";

struct FileName {
  const Controller* controller = nullptr;
  int seed = 0;
  std::string path = {};
};

FileName read_name(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  const std::size_t dash = stem.rfind('-');
  FileName name;
  name.path = path.string();
  if (dash != std::string::npos) {
    const char* const end = stem.data() + stem.size();
    const auto [at, error] = std::from_chars(stem.data() + dash + 1, end, name.seed);
    if (error == std::errc() && at == end && name.seed > 0) {
      const std::string_view key = std::string_view(stem).substr(0, dash);
      const auto& trained = trained_controllers();
      if (std::ranges::find(trained, key) != trained.end()) name.controller = find_controller(key);
    }
  }
  if (name.controller == nullptr) {
    throw InputError(fmt::format("{}: found the name '{}', expected {}; NAME is one of {}",
                                 path.string(), stem, kExpected,
                                 fmt::join(trained_controllers(), ", ")));
  }
  return name;
}

Model load_model(const FileName& name, const train::PolicySettings& task, const sim::Robot& robot) {
  const std::string bytes = read_input_file(name.path, "a policy file");
  train::TaskNetwork network =
      train::make_task_network(parse_policy_file(bytes, name.path), task.mode_gain);
  const learner::NetworkSizes& sizes = network.layout.sizes();
  const std::string wiring = wiring_text(sizes.wiring);
  if (wiring != name.controller->wiring) {
    throw InputError(fmt::format("{}: found networks wired as '{}', expected '{}'", name.path,
                                 wiring, name.controller->wiring));
  }
  require_joints(network.spec, robot.description);
  train::require_scales(
      network.spec, network.scales, task,
      train::make_scales(robot.nominal_rad, task.body_height_m, task.observation_clip));
  std::optional<Policy> policy;
  if (!sizes.wiring.sees_insight()) policy = load_policy_text(bytes, name.path);
  return {name.controller, name.seed, hash_of(bytes), std::move(network), std::move(policy)};
}

}  // namespace

std::string model_name(const Model& model) {
  return fmt::format("{}-{}", model.controller->key, model.seed);
}

std::uint64_t hash_of(std::string_view bytes) {
  StateHash hash;
  const std::uint64_t size = bytes.size();
  hash.add(size);
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
    hash.add(word);
  }
  return hash.value();
}

std::vector<Model> load_models(const std::string& folder, const std::vector<int>& seeds,
                               const sim::Robot& robot) {
  std::error_code error;
  std::filesystem::directory_iterator files(folder, error);
  if (error) {
    throw InputError(
        fmt::format("--from: found no folder '{}', expected one with {}", folder, kExpected));
  }
  std::vector<FileName> names;
  for (const auto& file : files) {
    if (file.path().extension() != ".safetensors") continue;
    const FileName name = read_name(file.path());
    if (!seeds.empty() && std::find(seeds.begin(), seeds.end(), name.seed) == seeds.end()) continue;
    names.push_back(name);
  }
  // The controllers lie in one array, in the order of the tables.
  std::sort(names.begin(), names.end(), [](const FileName& a, const FileName& b) {
    return std::tuple(a.controller, a.seed) < std::tuple(b.controller, b.seed);
  });
  const train::PolicySettings task = train::shipped_task_config(robot).policy;
  std::vector<Model> models;
  for (const FileName& name : names) models.push_back(load_model(name, task, robot));
  if (models.empty()) {
    throw InputError(
        fmt::format("--from: found no trained controller in '{}', expected {}", folder, kExpected));
  }
  return models;
}

Model load_published(const std::string& path, const sim::Robot& robot) {
  const std::string bytes = read_input_file(path, "a policy");
  Policy policy = load_policy_text(bytes, path);
  require_joints(policy.spec(), robot.description);
  const train::PolicySettings task = train::shipped_task_config(robot).policy;
  return {find_controller("published"), 0, hash_of(bytes),
          train::make_task_network(parse_policy_file(bytes, path), task.mode_gain),
          std::move(policy)};
}

}  // namespace sandrunner::study
