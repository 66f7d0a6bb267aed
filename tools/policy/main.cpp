// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-policy: imports policies that others published, describes policy files, and writes the
// commands that they may be given into them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "policy/perceptron_file.h"
#include "policy/policy_file.h"
#include "policy/text.h"
#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/program.h"
#include "tools/policy/policy_import.h"

namespace sandrunner {
namespace {

void set_envelope(const std::string& input, const std::string& output,
                  const CommandEnvelope& envelope, std::optional<double> centripetal_mps2) {
  const auto set_in = [&](PolicySpec& spec) {
    spec.envelope = envelope;
    spec.has_envelope = true;
    if (centripetal_mps2) spec.yaw_command_clip_mps2 = *centripetal_mps2;
  };
  if (TensorFile content = read_safetensors(input); is_perceptron(content)) {
    PerceptronFile file = decode_perceptron(input, std::move(content));
    set_in(file.spec);
    write_safetensors(output, encode_perceptron(output, file));
  } else {
    PolicyFile file = read_policy_file(input);
    set_in(file.spec);
    write_policy_file(output, file);
  }
  fmt::print("wrote {}\n", output);
}

std::size_t number_of_parameters(NetworkParameters parameters) {
  std::size_t count = 0;
  for (const NamedTensor& tensor : tensors_of(parameters)) count += tensor.size();
  return count - 2 * kObservationSize;  // the normalisation is not trained
}

/// The encoder's kind and the widths of its layers.
std::string encoder_summary(const NetworkParameters& parameters) {
  if (parameters.wiring.encoder == EncoderKind::kLstm) {
    return fmt::format("LSTM {}-{}", kEncoderInputSize, kHiddenSize);
  }
  std::vector<std::size_t> widths;
  for (const DenseParameters& layer : parameters.encoder) widths.push_back(layer.bias.size());
  return encoder_text(parameters.wiring.encoder) + " " + joined(widths, "-");
}

void print_row(const char* label, const std::string& text) {
  fmt::print("{:<20}{}\n", label, text);
}

/// What all policies have: gains, commands, pose.
void print_spec(const PolicySpec& spec) {
  print_row("joints", printable(joined(spec.joint_names, ", "), 200));
  const JointArray<double>& scale = spec.action_scale_rad;
  const bool one = has_one_scale(spec);
  print_row("joint target",
            fmt::format("nominal + {} rad * action, action {}",
                        one ? fmt::format("{}", scale[0]) : "(" + joined(scale, ", ") + ")",
                        spec.action_clip > 0.0 ? fmt::format("limited to +-{}", spec.action_clip)
                                               : "not limited"));
  print_row("gains", fmt::format("Kp {} N m/rad, Kd {} N m s/rad, torque limit {} N m",
                                 spec.kp_nmprad, spec.kd_nmsprad, spec.torque_limit_nm));
  print_row("yaw command", fmt::format("limited to {} m/s^2 of centripetal acceleration",
                                       spec.yaw_command_clip_mps2));
  const CommandEnvelope& e = spec.envelope;
  print_row("commands",
            fmt::format("vx -{:.4g} to {:.4g}, vy +-{:.4g} m/s, yaw rate +-{:.4g} rad/s; "
                        "changes {} m/s^2, {} rad/s^2{}",
                        e.backward_mps, e.forward_mps, e.lateral_mps, e.yaw_radps,
                        e.acceleration_mps2, e.yaw_acceleration_radps2,
                        spec.has_envelope ? "" : " (the file does not say: narrow)"));

  fmt::print("\n{:<20}{:>10}{:>12}{:>12}\n", "nominal pose, rad", "HAA", "HFE", "KFE");
  for (int leg = 0; leg < kNumLegs; ++leg) {
    const double* q = &spec.nominal_position_rad[kJointsPerLeg * leg];
    fmt::print("{:<20}{:>10.6f}{:>12.6f}{:>12.6f}\n", kLegNames[leg], q[0], q[1], q[2]);
  }
}

void print_provenance(const PolicySpec& spec, double deviation) {
  fmt::print("\n");
  for (const auto& [key, value] : spec.provenance) {
    if (value.find('\n') == std::string::npos) {
      fmt::print("{:<19} {}\n", printable(key), printable(value, 200));
      continue;
    }
    fmt::print("{}\n", printable(key));  // settings, one in each line
    std::istringstream lines(value);
    for (std::string line; std::getline(lines, line);) fmt::print("  {}\n", printable(line, 200));
  }
  print_row("golden example",
            fmt::format("{} steps pass, largest deviation {:.1e} (allowed {:.0e})", kGoldenSteps,
                        deviation, kGoldenTolerance));
}

void print_perceptron(const std::string& path, const PerceptronFile& file) {
  const PerceptronParameters& p = file.parameters;
  const ObservationLayout& layout = p.observation;
  const auto widths = [](int inputs, std::vector<int> rest) {
    rest.insert(rest.begin(), inputs);
    return joined(rest, "-");
  };
  std::vector<int> actor = p.actor;
  actor.push_back(kNumJoints);
  print_row("name", printable(file.spec.name));
  print_row("network",
            fmt::format("perceptron, {}{}, {}",
                        p.estimator.empty()
                            ? ""
                            : "estimator " + widths(layout.inputs(), p.estimator) + ", actor ",
                        widths(p.actor_inputs(), actor), activation_text(p.activation)));
  print_row("observation",
            fmt::format("{} x {} numbers{}, {}", layout.history, layout.numbers(),
                        layout.clip > 0.0 ? fmt::format(", limited to +-{}", layout.clip) : "",
                        history_order_text(layout.order)));
  print_row("  terms", terms_text(layout.terms));
  print_row("rates", fmt::format("policy {} Hz, control {} Hz", p.policy_hz, kControlHz));
  JointArray<std::string> names;
  for (int j = 0; j < kNumJoints; ++j) names[j] = file.spec.joint_names[p.joint_of[j]];
  print_row("its joints", printable(joined(names, ", "), 200));
  print_spec(file.spec);
  print_provenance(file.spec, check_golden_example(path, file));
}

void print_info(const std::string& path) {
  if (TensorFile content = read_safetensors(path); is_perceptron(content)) {
    return print_perceptron(path, decode_perceptron(path, std::move(content)));
  }
  const PolicyFile file = read_policy_file(path);
  const PolicySpec& spec = file.spec;
  print_row("name", printable(spec.name));
  const Wiring& wiring = file.parameters.wiring;
  print_row("network", fmt::format("{}, estimator {}, actor {}; {} parameters",
                                   encoder_summary(file.parameters), joined(kEstimatorSizes, "-"),
                                   joined(actor_sizes(wiring.actor_sees), "-"),
                                   number_of_parameters(file.parameters)));
  print_row("actor sees", "command, " + actor_inputs_text(wiring.actor_sees) +
                              (wiring.sees_insight() ? "; no robot can sense what it needs" : ""));
  print_row("observation", fmt::format("{} values, normalised, limited to +-{}", kObservationSize,
                                       file.parameters.observation_clip));
  print_row("rates", fmt::format("policy {} Hz, control {} Hz", kPolicyHz, kControlHz));
  print_spec(spec);
  constexpr std::array<const char*, kEstimateSize> kEstimateNames = {
      "body height, m",    "velocity x, m/s",   "velocity y, m/s",   "velocity z, m/s",
      "foot height LF, m", "foot height RF, m", "foot height LH, m", "foot height RH, m"};
  fmt::print("\n{:<20}{:>10}{:>12}\n", "estimate", "mean", "deviation");
  for (int i = 0; i < kEstimateSize; ++i) {
    fmt::print("{:<20}{:>10.3f}{:>12.3f}\n", kEstimateNames[i], spec.estimate_mean[i],
               std::sqrt(spec.estimate_variance[i]));
  }
  print_provenance(spec, check_golden_example(path, file.parameters, file.golden));
}

int run(int argc, char** argv) {
  CLI::App app("Imports and describes the policy files of sandrunner, and writes their envelope.",
               "sandrunner-policy");
  app.require_subcommand(1);

  PolicyImport given;
  CLI::App* import_command =
      app.add_subcommand("import", "turn bare weights (safetensors) into a policy file");
  import_command->add_option("IN", given.input, "weights (policy/README.md)")->required();
  import_command->add_option("--out", given.output, "policy file to write")
      ->type_name("FILE")
      ->required();
  import_command->add_option("--name", given.name, "name of the policy (default: that of IN)")
      ->type_name("NAME");
  import_command
      ->add_option("--robot", given.robot,
                   "robot that ships, or a robot file: joints, nominal pose, torque limit")
      ->type_name("NAME")
      ->capture_default_str();
  import_command
      ->add_option("--observation", given.observation,
                   "what a network of others sees and how it answers: a description that ships, "
                   "or a file (README.md)")
      ->type_name("NAME");
  import_command
      ->add_option("--set", given.assignments,
                   "other gains, scales or limits, such as action_scale_rad=0.25")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);

  std::string input, output;
  CommandEnvelope envelope;
  CLI::App* envelope_command = app.add_subcommand(
      "envelope", "write into a policy file which velocity commands the policy can follow");
  envelope_command->add_option("IN", input, "policy file")->required();
  envelope_command->add_option("--out", output, "policy file to write")->required();
  const auto speed = [&](const char* option, double& value, const char* what) {
    envelope_command->add_option(option, value, what)->required()->check(CLI::Range(0.0, 100.0));
  };
  speed("--forward", envelope.forward_mps, "largest vx, m/s");
  speed("--backward", envelope.backward_mps, "largest -vx, m/s");
  speed("--lateral", envelope.lateral_mps, "largest |vy|, m/s");
  speed("--yaw", envelope.yaw_radps, "largest |yaw rate|, rad/s");
  speed("--acceleration", envelope.acceleration_mps2, "largest change of vx and of vy, m/s^2");
  speed("--yaw-acceleration", envelope.yaw_acceleration_radps2,
        "largest change of the yaw rate, rad/s^2");
  std::optional<double> centripetal_mps2;
  envelope_command
      ->add_option("--centripetal", centripetal_mps2,
                   "largest |yaw rate| times speed, m/s^2 (default: that of IN)")
      ->check(CLI::Range(1e-3, 100.0));

  std::string path;
  CLI::App* info_command = app.add_subcommand("info", "check a policy file and print its contents");
  info_command->add_option("FILE", path, "policy file")->required();

  app.footer(
      "Examples:\n"
      "  sandrunner-policy info mine.safetensors\n"
      "  sandrunner-policy import weights.safetensors --out mine.safetensors");
  if (!parse_command_line(app, argc, argv)) return kExitOk;
  if (*import_command) {
    import_policy(given);
    fmt::print("wrote {}\n", given.output);
  } else if (*envelope_command) {
    set_envelope(input, output, envelope, centripetal_mps2);
  } else if (*info_command) {
    print_info(path);
  }
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-policy", [&] { return sandrunner::run(argc, argv); });
}
