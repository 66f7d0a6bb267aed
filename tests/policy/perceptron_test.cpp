// SPDX-License-Identifier: BSD-3-Clause
#include "policy/perceptron.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <span>

#include "policy/perceptron_file.h"
#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "tests/policy/random_perceptron.h"
#include "tests/support/error_of.h"
#include "tests/support/not_finite.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

using Observation = std::array<float, kObservationSize>;

/// The observation of one step, its terms written out.
Doubles plain_observation(const PerceptronFile& file, const Observation& raw,
                          const Doubles& last_action, double time_s) {
  Doubles numbers;
  const auto add = [&](const Doubles& values, double scale) {
    for (const double value : values) numbers.push_back(scale * value);
  };
  Doubles position, velocity;
  for (int j = 0; j < kNumJoints; ++j) {
    const int joint = file.parameters.joint_of[j];
    position.push_back(raw[9 + joint] - file.spec.nominal_position_rad[joint]);
    velocity.push_back(raw[21 + joint]);
  }
  add({raw[6], raw[7], raw[8]}, 0.25);
  add({-raw[3], -raw[4], -raw[5]}, 1.0);
  add({2.0 * raw[0], 2.0 * raw[1], 0.25 * raw[2]}, 1.0);
  add(position, 1.0);
  add(velocity, 0.05);
  add(last_action, 1.0);
  constexpr double kTurn = 6.283185307179586;
  add({std::sin(kTurn * time_s / 0.8), std::cos(kTurn * time_s / 0.8)}, 1.0);
  return numbers;
}

constexpr const char* kTerms =
    "angular_velocity scale 0.25, gravity, command scale 2 2 0.25, joint_position, "
    "joint_velocity scale 0.05, last_action, phase period 0.8";

struct Case {
  const char* name;
  Activation activation;
  int history;
  HistoryOrder order;
  bool has_estimator;
  int policy_hz;
};

class PerceptronCase : public testing::TestWithParam<Case> {};

/// Orders the observations of a history, the newest first, as the layout says.
Doubles arranged(const ObservationLayout& layout, const std::deque<Doubles>& newest_first) {
  Doubles input;
  const auto add = [&](const Doubles& part) {
    input.insert(input.end(), part.begin(), part.end());
  };
  if (layout.order == HistoryOrder::kNewestFirst) {
    for (const Doubles& step : newest_first) add(step);
  } else if (layout.order == HistoryOrder::kOldestFirst) {
    for (auto step = newest_first.rbegin(); step != newest_first.rend(); ++step) add(*step);
  } else {
    std::ptrdiff_t begin = 0;
    for (const ObservationTerm& term : layout.terms) {
      const std::ptrdiff_t end = begin + term_size(term.kind);
      for (auto step = newest_first.rbegin(); step != newest_first.rend(); ++step) {
        add(Doubles(step->begin() + begin, step->begin() + end));
      }
      begin = end;
    }
  }
  return input;
}

TEST_P(PerceptronCase, StepsAsPlainlyWritten) {
  const Case& c = GetParam();
  PerceptronFile file =
      random_perceptron(kTerms, c.history, c.order, c.activation,
                        c.has_estimator ? std::vector{70, 19} : std::vector<int>{});
  file.parameters.policy_hz = c.policy_hz;
  file.parameters.velocity_scale = 2.0;
  file.spec.action_clip = 0.9;
  Policy policy = make_policy(file);
  RandomFloats random(3);
  std::deque<Doubles> seen;
  Doubles last_action(kNumJoints, 0.0);
  PlainAnswer answer;
  bool was_clipped = false;
  for (int step = 0; step < 40; ++step) {
    const Observation raw = random.observation();
    if (step % (kPolicyHz / c.policy_hz) == 0) {
      const Doubles now = plain_observation(file, raw, last_action, 0.01 * step);
      if (seen.empty()) seen.assign(static_cast<std::size_t>(c.history), now);
      seen.push_front(now);
      if (step == 0) seen.pop_front();
      seen.resize(static_cast<std::size_t>(c.history));
      answer = plain_answer(file.parameters, arranged(file.parameters.observation, seen), now);
      for (int j = 0; j < kNumJoints; ++j) {
        was_clipped = was_clipped || std::abs(answer.action[j]) > 0.9;
        last_action[j] = std::clamp(answer.action[j], -0.9, 0.9);
      }
    }
    const PolicyStep found = policy.step(raw);
    for (int j = 0; j < kNumJoints; ++j) {
      const int joint = file.parameters.joint_of[j];
      const double expected = file.spec.nominal_position_rad[joint] +
                              file.spec.action_scale_rad[joint] * last_action[j];
      ASSERT_NEAR(found.target_rad[joint], expected, 2e-5)
          << "step " << step << ", joint " << joint;
    }
    for (int i = 0; i < 3; ++i) {
      if (c.has_estimator) {
        ASSERT_NEAR(found.estimate.velocity_mps[i], answer.velocity_mps[i], 2e-5) << step;
      } else {
        ASSERT_TRUE(std::isnan(found.estimate.velocity_mps[i]));
      }
    }
    ASSERT_TRUE(std::isnan(found.estimate.body_height_m));
  }
  EXPECT_TRUE(was_clipped);
}

INSTANTIATE_TEST_SUITE_P(
    All, PerceptronCase,
    testing::Values(
        Case{"RslRl", Activation::kElu, 1, HistoryOrder::kNewestFirst, false, 50},
        Case{"Himloco", Activation::kElu, 6, HistoryOrder::kNewestFirst, true, 50},
        Case{"OldestFirst", Activation::kRelu, 3, HistoryOrder::kOldestFirst, false, 25},
        Case{"ByTerm", Activation::kTanh, 5, HistoryOrder::kByTerm, false, 100},
        Case{"Leaky", Activation::kLeakyRelu, 2, HistoryOrder::kOldestFirst, false, 20}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(PerceptronTest, EveryWidthOfALayerIsWholeInItsPanels) {
  for (const int width : {1, 5, 8, 9, 16, 24, 33, 64, 65, 72, 97, 128, 130, 511, 512}) {
    PerceptronFile file =
        random_perceptron(kTerms, 1, HistoryOrder::kNewestFirst, Activation::kElu, {}, {width});
    const Perceptron network(file.parameters, {}, 0.0);
    RandomFloats random(static_cast<std::uint64_t>(width));
    std::vector<float> input;
    for (int i = 0; i < file.parameters.observation.inputs(); ++i) input.push_back(random.next());
    JointArray<float> action;
    std::array<float, 3> velocity;
    network.answer(input.data(), action, velocity);
    const Doubles doubles(input.begin(), input.end());
    const PlainAnswer expected = plain_answer(file.parameters, doubles, doubles);
    for (int j = 0; j < kNumJoints; ++j) {
      ASSERT_NEAR(action[j], expected.action[j], 1e-5) << "width " << width;
    }
  }
}

TEST(PerceptronTest, NotANumberReachesTheTargetsAndStaysUntilReset) {
  for (const Activation activation :
       {Activation::kElu, Activation::kRelu, Activation::kLeakyRelu, Activation::kTanh}) {
    PerceptronFile file = random_perceptron(kTerms, 1, HistoryOrder::kNewestFirst, activation);
    file.spec.action_clip = 1.0;
    Policy policy = make_policy(file);
    Observation raw{};
    raw[7] = static_cast<float>(kNan);
    EXPECT_TRUE(std::isnan(policy.step(raw).target_rad[0]));
    policy.step({});
    EXPECT_TRUE(std::isnan(policy.step({}).target_rad[0]));  // by its last action
    policy.reset();
    EXPECT_FALSE(std::isnan(policy.step({}).target_rad[0]));
  }
}

TEST(PerceptronTest, WrongTermsAreNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"gravity, linear_velocity", "' linear_velocity', expected what a robot measures"},
      {"gravity, speed", "expected one of angular_velocity, gravity"},
      {"command scale 2 2", "expected one scale or 3"},
      {"command scale x", "expected 'NAME scale NUMBER"},
      {"command clip 0", "expected a clip above 0"},
      {"phase", "expected a period (s) above 0"},
      {"gravity period 3", "expected a period of the phase alone"},
      {"command scale 1e300", "numbers of 1e-6 to 1e6"},
      {"", "found 0 numbers, expected 1 to 64"},
      {"joint_position, joint_position, joint_position, joint_position, joint_position, phase "
       "period 1, gravity",
       "found 65 numbers"}};
  for (const auto& [text, cause] : cases) {
    const std::string message = error_of([text = text] { parse_terms("file: observation", text); });
    EXPECT_TRUE(message.starts_with("file: observation: found ")) << text << ": " << message;
    EXPECT_NE(message.find(cause), std::string::npos) << text << ": " << message;
  }
  EXPECT_EQ(terms_text(parse_terms("", kTerms)), kTerms);
}

class PerceptronFileTest : public testing::Test {
 protected:
  PerceptronFileTest() { write_safetensors(path_, encode_perceptron(path_, file_)); }

  /// Of a file with one key of its metadata changed.
  std::string message_with(const std::string& key, const std::string& value) {
    TensorFile content = read_safetensors(path_);
    content.metadata["sandrunner." + key] = value;
    write_safetensors(folder_.path("changed"), content);
    return error_of([&] { load_policy(folder_.path("changed")); });
  }

  const PerceptronFile file_ = random_perceptron(kTerms, 3, HistoryOrder::kOldestFirst);
  const TemporaryFolder folder_;
  const std::string path_ = folder_.path("theirs.safetensors");
};

TEST_F(PerceptronFileTest, ReadsBackWhatItWroteAndRunsTheSame) {
  Policy written = make_policy(file_), read = load_policy(path_);
  RandomFloats random(7);
  for (int k = 0; k < 20; ++k) {
    const Observation raw = random.observation();
    ASSERT_EQ(written.step(raw).target_rad, read.step(raw).target_rad);
  }
  EXPECT_EQ(read.spec().action_scale_rad, file_.spec.action_scale_rad);
  EXPECT_EQ(encode_perceptron(path_, decode_perceptron(path_, read_safetensors(path_))).metadata,
            read_safetensors(path_).metadata);
}

TEST_F(PerceptronFileTest, WrongSettingsAreNamed) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"policy_hz", "30", "'sandrunner.policy_hz' is 30, expected a divisor of 100"},
      {"activation", "gelu", "found 'gelu', expected one of elu, relu, leaky_relu, tanh"},
      {"activation", "tanh", "golden example fails at step 0"},
      {"history", "4", "tensor 'actor.0.weight' has shape"},
      {"history", "30", "30 observations of 47 numbers, expected at most 1024 numbers"},
      {"actor_layers", "600", "actor has a layer of 600 units, expected 1 to 512"},
      {"actor_layers", "8,8,8,8,8", "actor has 5 hidden layers, expected at most 4"},
      {"actor_layers", "8;8", "expected widths with commas between"},
      {"network", "transformer", "expected 'perceptron'"},
      {"network_joints", "a,b,c,d,e,f,g,h,i,j,k,l", "has 'a', expected the robot's joints"},
      {"observation", "gravity", "tensor 'actor.0.weight' has shape"},
      {"action_scale_rad", "1,2", "has 2 values, expected 12"},
      {"odd", "1", "unknown metadata key 'sandrunner.odd'"}};
  for (const auto& [key, value, cause] : cases) {
    EXPECT_NE(message_with(key, value).find(cause), std::string::npos)
        << key << ": " << message_with(key, value);
  }
  EXPECT_EQ(message_with("history_order", "newest_first"), "");  // the network alone knows no order
}

TEST_F(PerceptronFileTest, WhoNeedsANetworkOfOursRefusesIt) {
  EXPECT_THROW(read_policy_file(path_), InputError);
}

}  // namespace
}  // namespace sandrunner
