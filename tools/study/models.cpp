// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/models.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <tuple>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/core/state_hash.h"

namespace sandrunner::study {
namespace {

constexpr const char* kExpected = "NAME-SEED.safetensors, such as ours-1.safetensors";

struct FileName {
  const Controller* controller = nullptr;
  int seed = 0;
};

FileName read_name(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  const std::size_t dash = stem.rfind('-');
  FileName name;
  if (dash != std::string::npos) {
    const char* const end = stem.data() + stem.size();
    const auto [at, error] = std::from_chars(stem.data() + dash + 1, end, name.seed);
    if (error == std::errc() && at == end && name.seed > 0) {
      name.controller = find_controller(std::string_view(stem).substr(0, dash));
    }
  }
  if (name.controller == nullptr) {
    std::vector<std::string> keys;
    for (const Controller& c : controllers()) keys.emplace_back(c.key);
    throw InputError(fmt::format("{}: found the name '{}', expected {}; NAME is one of {}",
                                 path.string(), stem, kExpected, fmt::join(keys, ", ")));
  }
  return name;
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
  std::vector<Model> models;
  for (const auto& file : files) {
    if (file.path().extension() != ".safetensors") continue;
    const FileName name = read_name(file.path());
    if (!name.controller->is_policy) continue;
    if (!seeds.empty() && std::find(seeds.begin(), seeds.end(), name.seed) == seeds.end()) continue;
    const std::string path = file.path().string();
    const std::string bytes = read_input_file(path, "a policy");
    Policy policy = load_policy_text(bytes, path);
    require_joints(policy.spec(), robot.description);
    models.push_back({name.controller, name.seed, std::move(policy), hash_of(bytes)});
  }
  if (models.empty()) {
    throw InputError(
        fmt::format("--from: found no trained controller in '{}', expected {}", folder, kExpected));
  }
  // The controllers lie in one array, in the order of the tables.
  std::sort(models.begin(), models.end(), [](const Model& a, const Model& b) {
    return std::tuple(a.controller, a.seed) < std::tuple(b.controller, b.seed);
  });
  return models;
}

}  // namespace sandrunner::study
