// SPDX-License-Identifier: BSD-3-Clause
// The convolutional encoder: what it sees, and that windows are its steps.
#include "tools/train/learner/tcn.h"

#include <gtest/gtest.h>

#include <limits>

#include "random_rollout.h"
#include "rt/core/processor.h"

namespace sandrunner::learner {
namespace {

constexpr int kTcnEnvs = 4;
constexpr int kTcnSteps = 128;

NetworkSizes tcn_sizes() {
  NetworkSizes sizes;
  sizes.wiring.encoder = EncoderKind::kTcn;
  return sizes;
}

/// Observations of all environments over all steps, and the encodings of them.
class TcnTest : public testing::Test {
 protected:
  TcnTest()
      : layout_(tcn_sizes(), 1),
        weights_(layout_),
        observation_(kObservationSize, kTcnSteps * kTcnEnvs),
        reset_(Matrix<std::uint8_t>::Zero(kTcnEnvs, kTcnSteps)) {
    weights_.set(initial_parameters(layout_, 3, 0.5).data());
    NormalSource normal(5);
    for (Eigen::Index i = 0; i < observation_.size(); ++i) {
      observation_.data()[i] = static_cast<float>(normal());
    }
  }

  void set_reset(int step, int env) { reset_(env, step) = 1; }

  /// In windows of `steps`, the last of which need not be full.
  Matrix<float> encodings(int steps, const Kernels<float>& kernels = best_kernels<float>()) const {
    Tcn<float> tcn(layout_, steps, kTcnEnvs, kernels);
    Matrix<float> memory = Matrix<float>::Zero(layout_.memory(), kTcnEnvs);
    Matrix<float> all(layout_.hidden(), kTcnSteps * kTcnEnvs);
    for (int first = 0; first < kTcnSteps; first += steps) {
      for (int t = 0; t < steps; ++t) {
        tcn.set_input(t, observation_.middleCols((first + t) * kTcnEnvs, kTcnEnvs),
                      Matrix<float>(0, kTcnEnvs));
      }
      tcn.forward(weights_.encoder(), memory, &reset_(0, first), kTcnEnvs);
      all.middleCols(first * kTcnEnvs, steps * kTcnEnvs) = tcn.output();
      tcn.remember(memory);
    }
    return all;
  }

  /// The encoding of the last step, computed anew from `count` observations after a reset.
  Matrix<float> last_from(int count) const {
    Tcn<float> tcn(layout_, count, kTcnEnvs, best_kernels<float>());
    for (int t = 0; t < count; ++t) {
      tcn.set_input(t, observation_.middleCols((kTcnSteps - count + t) * kTcnEnvs, kTcnEnvs),
                    Matrix<float>(0, kTcnEnvs));
    }
    const Matrix<std::uint8_t> none = Matrix<std::uint8_t>::Zero(kTcnEnvs, count);
    tcn.forward(weights_.encoder(), Matrix<float>::Zero(layout_.memory(), kTcnEnvs), none.data(),
                kTcnEnvs);
    return tcn.output().rightCols(kTcnEnvs);
  }

  ParameterLayout layout_;
  Weights<float> weights_;
  Matrix<float> observation_;
  Matrix<std::uint8_t> reset_;  // an environment a row
};

TEST_F(TcnTest, StepsOneByOneAreWindowsBitForBitWithResets) {
  for (const int step : {0, 31, 32, 52}) set_reset(step, 0);
  set_reset(33, 1);
  set_reset(95, 2);
  const Matrix<float> steps = encodings(1);
  EXPECT_EQ(steps, encodings(32));
  EXPECT_EQ(steps, encodings(64));
  EXPECT_EQ(steps, encodings(32, kernels_x8()));
  EXPECT_EQ(steps, encodings(1, kernels_x8()));
  if (!has_avx512()) GTEST_SKIP() << "this processor has no AVX-512";
  EXPECT_EQ(steps, encodings(32, kernels_x16()));
  EXPECT_EQ(steps, encodings(1, kernels_x16()));
}

TEST_F(TcnTest, SeesFiftyThreeStepsAndNoMore) {
  const Matrix<float> last = encodings(32).rightCols(kTcnEnvs);
  EXPECT_EQ(last, last_from(53));
  EXPECT_NE(last, last_from(52));
  observation_.leftCols((kTcnSteps - 53) * kTcnEnvs).setZero();
  EXPECT_EQ(last, encodings(32).rightCols(kTcnEnvs));
}

TEST_F(TcnTest, SeesNothingBehindAReset) {
  const int step = kTcnSteps - 7;
  for (int env = 0; env < kTcnEnvs; ++env) set_reset(step, env);
  observation_.leftCols(step * kTcnEnvs).setConstant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(encodings(32).rightCols(kTcnEnvs), last_from(7));
  EXPECT_EQ(encodings(1).rightCols(kTcnEnvs), last_from(7));
}

TEST_F(TcnTest, HasTheStatedNumberOfWeights) {
  EXPECT_EQ(layout_.estimator().front().weight, 24744);
}

}  // namespace
}  // namespace sandrunner::learner
