// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "rt/base/processor_name.h"
#include "rt/core/processor.h"
#include "tools/bench/benches.h"
#include "tools/bench/clock.h"
#include "tools/bench/fma_peak.h"
#include "tools/train/kernels/kernels.h"

namespace sandrunner::bench {
namespace {

using Eigen::MatrixXf;
using learner::Kernels;
using learner::Panels;
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// About 50 ms of each.
constexpr double kFlopsPerRun = 1e10;
constexpr double kTolerance = 1e-3;

/// As the learner has them: a block of 64 environments steps through the encoder; the others take
/// four steps at a time.
struct Size {
  int inputs, outputs, samples;
};
constexpr Size kSizes[] = {{95, 256, 64},                                    // encoder
                           {64, 128, 256}, {128, 128, 256}, {128, 8, 256},   // estimator
                           {75, 256, 256}, {256, 128, 256}, {128, 12, 256},  // actor
                           {77, 128, 256}, {128, 128, 256}, {128, 1, 256}};  // critic

/// A layer, one sample a column: y = W x, dx = W^T dy, dw += dy x^T.
struct Layer {
  explicit Layer(const Size& size)
      : w(random_matrix(size.outputs, size.inputs)),
        x(random_matrix(size.inputs, size.samples)),
        dy(random_matrix(size.outputs, size.samples)),
        y(MatrixXf::Zero(size.outputs, size.samples)),
        dx(MatrixXf::Zero(size.inputs, size.samples)),
        dw(RowMajor::Zero(size.outputs, size.inputs)),
        forward(size.inputs, size.outputs),
        backward(size.outputs, size.inputs) {
    forward.pack(w.data(), 1, size.inputs);
    backward.pack(w.data(), size.inputs, 1);
  }
  static MatrixXf random_matrix(int rows, int columns) {
    static std::mt19937 random(1);
    std::normal_distribution<float> normal;
    return MatrixXf::NullaryExpr(rows, columns, [&] { return normal(random); });
  }
  double flops() const {
    return 2.0 * static_cast<double>(w.size()) * static_cast<double>(x.cols());
  }

  RowMajor w;
  MatrixXf x, dy, y, dx;
  RowMajor dw;
  Panels<float> forward, backward;  ///< w, packed
};

/// One kind of product of a layer.
struct Pass {
  const char* name;
  void (*ours)(const Kernels<float>&, Layer&);
  void (*eigen)(Layer&);
};

learner::Rows<const float> in(const MatrixXf& m) { return {m.data(), m.outerStride()}; }

const Pass kPasses[] = {
    {"forward",
     [](const Kernels<float>& kernels, Layer& l) {
       kernels.multiply({.samples = static_cast<int>(l.x.cols()),
                         .a = in(l.x),
                         .b = l.forward,
                         .c = {l.y.data(), l.y.outerStride()}});
     },
     [](Layer& l) { l.y.noalias() = l.w * l.x; }},
    {"backward",
     [](const Kernels<float>& kernels, Layer& l) {
       kernels.multiply({.samples = static_cast<int>(l.x.cols()),
                         .a = in(l.dy),
                         .b = l.backward,
                         .c = {l.dx.data(), l.dx.outerStride()}});
     },
     [](Layer& l) { l.dx.noalias() = l.w.transpose() * l.dy; }},
    {"gradient",
     [](const Kernels<float>& kernels, Layer& l) {
       kernels.add_gradient({.samples = static_cast<int>(l.x.cols()),
                             .rows = static_cast<int>(l.w.rows()),
                             .columns = static_cast<int>(l.w.cols()),
                             .a = in(l.dy),
                             .b = in(l.x),
                             .c = {l.dw.data(), l.dw.outerStride()}});
     },
     [](Layer& l) { l.dw.noalias() += l.dy * l.x.transpose(); }},
};

double peak_gflops(void (*fma_loop)(long) noexcept, int lanes) {
  const long loops = std::lround(kFlopsPerRun / (2.0 * kPeakRegisters * lanes));
  return 1e-9 * kFlopsPerRun / cpu_time_s([&] { fma_loop(loops); });
}

template <typename Run>
double gflops(std::vector<Layer>& layers, const Run& run) {
  double flops = 0.0;
  const double time_s = cpu_time_s([&] {
    while (flops < kFlopsPerRun) {
      for (Layer& layer : layers) {
        run(layer);
        flops += layer.flops();
      }
    }
  });
  return 1e-9 * flops / time_s;
}

void require_agreement(const Kernels<float>& kernels) {
  for (const Size& size : kSizes) {
    Layer ours(size);
    Layer eigen = ours;
    for (const Pass& pass : kPasses) {
      pass.ours(kernels, ours);
      pass.eigen(eigen);
    }
    const float worst = std::max({(ours.y - eigen.y).cwiseAbs().maxCoeff(),
                                  (ours.dx - eigen.dx).cwiseAbs().maxCoeff(),
                                  (ours.dw - eigen.dw).cwiseAbs().maxCoeff()});
    if (!(worst <= kTolerance)) {
      throw std::runtime_error(
          fmt::format("the kernels and Eigen differ by {:.1e} in a layer of {} inputs and {} "
                      "outputs, expected at most {:.0e}",
                      worst, size.inputs, size.outputs, kTolerance));
    }
  }
}

}  // namespace

Report run_learner_bench(int rounds) {
  flush_denormals_to_zero();
  const bool has_x16 = has_avx512();
  require_agreement(learner::kernels_x8());
  if (has_x16) require_agreement(learner::kernels_x16());
  std::vector<Layer> layers(std::begin(kSizes), std::end(kSizes));

  Samples rates;
  for (int round = 0; round < rounds; ++round) {
    rates["peak_x8"].push_back(peak_gflops(fma_loop_x8, 8));
    if (has_x16) rates["peak_x16"].push_back(peak_gflops(fma_loop_x16, 16));
    for (const Pass& pass : kPasses) {
      const auto ours = [&](const Kernels<float>& kernels) {
        return gflops(layers, [&](Layer& layer) { pass.ours(kernels, layer); });
      };
      const std::string name = pass.name;
      rates[name + "_eigen"].push_back(gflops(layers, pass.eigen));
      rates[name + "_x8"].push_back(ours(learner::kernels_x8()));
      if (has_x16) rates[name + "_x16"].push_back(ours(learner::kernels_x16()));
      for (Layer& layer : layers) layer.dw.setZero();
    }
  }

  Report report;
  report.facts = {
      {"processor", processor_name()},
      {"products",
       "of all layers of the training that ships, 256 samples, the encoder's 64; GFLOP/s"},
      {"ours",
       "AVX-512 (x16) and AVX2 or NEON (x8), weights packed beforehand as once a minibatch"},
      {"eigen", "as the rest of the program is compiled"},
      {"peak", "fused multiply-adds on registers, nothing else"},
      {"clock", "processor time of the thread"}};
  for (const auto& [name, values] : rates) report.rates.emplace_back(name, quartiles(values));
  for (const Pass& pass : kPasses) {
    const std::string name = pass.name;
    for (const char* width : {"_x16", "_x8"}) {
      const std::string ours = name + width;
      add_ratio(report, ours + "_vs_eigen", rates, ours, name + "_eigen");
      add_ratio(report, ours + "_vs_peak", rates, ours, std::string("peak") + width);
    }
  }
  return report;
}

}  // namespace sandrunner::bench
