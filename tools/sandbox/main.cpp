// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-sandbox: writes a page with the simulator, the controller and a policy in it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "policy/perceptron_file.h"
#include "policy/policy_file.h"
#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/core/processor.h"
#include "rt/loop/lockstep.h"
#include "rt/run/assemble.h"
#include "rt/run/command_source.h"
#include "rt/run/offered_ground.h"
#include "rt/run/run_script.h"
#include "rt/run/scene.h"
#include "rt/telemetry/view/view_hello.h"
#include "rt/telemetry/view/view_pack.h"
#include "rt/telemetry/view/view_page.h"
#include "sim/ground/terrain_description.h"
#include "sim/simulator.h"
#include "tools/sandbox/embedded.h"
#include "tools/sandbox/setup.h"

namespace sandrunner::sandbox {
namespace {

constexpr const char* kNote = "Simulator, controller and policy run in this page.";

struct Arguments {
  Options run;
  std::string out;
};

std::optional<Arguments> parse(int argc, char** argv) {
  Arguments a;
  CLI::App app(
      "Writes a page that runs the robot on sand in a browser: one file, which needs no server. "
      "The page's bits are those of sandrunner with the same options.",
      "sandrunner-sandbox");
  app.add_option("--out", a.out, "page to write")->type_name("FILE")->required();
  app.add_option("--policy", a.run.policy_path, "policy file (default: the robot's own)")
      ->type_name("FILE");
  app.add_option("--robot", a.run.robot_path, "raibo, go2, or the robot file of another one")
      ->type_name("FILE");
  app.add_option("--terrain", a.run.terrain, "ground at the start: a preset, or a TOML file")
      ->type_name("PRESET|FILE")
      ->capture_default_str();
  app.add_option("--set", a.run.assignments, "one setting; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  app.footer("Example: sandrunner-sandbox --out sandbox.html --terrain wet-sand");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  return a;
}

/// The network of a policy file that was loaded before, and so is whole.
decltype(Setup::network) network_of(const std::string& file) {
  TensorFile content = parse_safetensors(file, "the policy");
  if (is_perceptron(content)) return decode_perceptron("the policy", std::move(content)).parameters;
  return parse_policy_file(file, "the policy").parameters;
}

Setup setup_of(const ProcessConfig& config, const ProcessConfig& page, const RunPolicy& policy) {
  if (config.simulator.terrain.shape.heights) {
    throw InputError(
        "terrain.heights_file: found a file, expected none: a page has no room for it");
  }
  Setup setup{.robot = config.robot,
              .simulator = config.simulator,
              .controller = config.controller,
              .page_controller = page.controller,
              .stale_ticks = page.dds.stale_ticks(),
              .motor_constant = config.motor_constant,
              .policy = {},
              .network = {},
              .presets = {}};
  if (!policy.runner.is_none()) {
    setup.policy = *policy.runner.spec();
    setup.network = network_of(policy.file);
  }
  for (const std::string& name : sim::terrain_preset_names()) {
    setup.presets.push_back(sim::terrain_preset(name));
  }
  return setup;
}

/// State hash of a run of the command line.
std::uint64_t native_hash(const ProcessConfig& config, PolicyRunner& policy,
                          const Options& options) {
  sim::Simulator simulator(config.robot, config.simulator);
  simulator.reset_lying();
  const CommandSource command(options.command);
  RunScript script(command, {.walk_s = options.duration_s},
                   no_walk(config.controller.gate, !policy.is_none()) == nullptr);
  return run_lockstep(
             {.robot = simulator, .controller = config.controller, .policy = policy, .op = script})
      .state_hash;
}

/// What page/sandbox.js needs besides, as JSON.
std::string page_json(const ProcessConfig& config, const Options& options, std::uint64_t hash) {
  using Json = nlohmann::ordered_json;
  const sim::TerrainDescription& terrain = config.simulator.terrain;
  Json json = {{"terrain", terrain.name},
               {"uneven", sim::derive_shape(terrain.shape).uneven > 0.0},
               {"presets", Json::array()},
               {"settings", Json::array()},
               {"kinds", sim::Laws::kNames},
               {"drawn_as_sand", sim::Laws::kDrawnAsSand},
               {"duration_s", options.duration_s},
               {"command", options.command},
               {"hash", fmt::format("{:016x}", hash)}};
  for (const std::string& preset : sim::terrain_preset_names()) {
    json["presets"].push_back({{"preset", preset}, {"name", sim::terrain_preset(preset).name}});
  }
  std::map<std::string, std::string> ranges;
  for (const SettingLine& line : sim::terrain_settings()) ranges[line.key] = line.range;
  for (const auto& [key, member] : kOfferedGround) {
    json["settings"].push_back(
        {{"key", key}, {"range", ranges.at(fmt::format("terrain.{}", key))}});
  }
  return without_tags(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

int run(int argc, char** argv) {
  const std::optional<Arguments> arguments = parse(argc, argv);
  if (!arguments) return kExitOk;
  flush_denormals_to_zero();
  RunPolicy policy = load_run_policy(arguments->run);
  const ProcessConfig config = read_config(arguments->run, policy.runner.spec());
  Options live = arguments->run;
  live.live = live.live_page = true;
  const ProcessConfig page_config = read_config(live, policy.runner.spec());
  Setup setup = setup_of(config, page_config, policy);
  const RunScene scene = scene_of(config, policy.runner.name());
  std::vector<PageData> data = {
      {"hello", view_hello(scene, kNote)},
      {"sandbox",
       page_json(config, arguments->run, native_hash(config, policy.runner, arguments->run))}};
  append_gzip(data.emplace_back(PageData{"setup"}).text, to_bytes(setup));
  for (const char* name : {"relaxed", "exact"}) {
    append_base64(data.emplace_back(PageData{name}).text,
                  embedded_sandbox_file(fmt::format("{}.wasm.gz", name)));
  }
  const std::string html = page_with(data);
  write_file(arguments->out, html);
  fmt::print("wrote {}: {:.2f} MB\n", arguments->out, 1e-6 * static_cast<double>(html.size()));
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner::sandbox

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-sandbox",
                                 [&] { return sandrunner::sandbox::run(argc, argv); });
}
