// SPDX-License-Identifier: BSD-3-Clause
// The elementwise part of an LSTM on packs; included by the source of each instruction set.
#pragma once

#include "tools/train/kernels/activations.h"
#include "tools/train/kernels/product_kernel.h"

namespace sandrunner::learner::detail {

/// Up to a pack of lanes from `from`, zero in the others; back to `to`.
template <typename S>
inline S load_lanes(const Element<S>* from, int lanes) {
  S s;
  if (lanes >= kWidth<S>) {
    load(from, s);
    return s;
  }
  Element<S> all[kWidth<S>] = {};
  std::copy_n(from, lanes, all);
  load(all, s);
  return s;
}
template <typename S>
inline void store_lanes(S s, int lanes, Element<S>* to) {
  if (lanes >= kWidth<S>) return store(s, to);
  Element<S> all[kWidth<S>];
  store(s, all);
  std::copy_n(all, lanes, to);
}

template <typename S>
void lstm_forward(int samples, int units, Element<S>* gates, const Element<S>* c,
                  Element<S>* next_c, Element<S>* tanh_c, Element<S>* h) {
  for (int sample = 0; sample < samples; ++sample) {
    for (int k = 0; k < units; k += kWidth<S>) {
      const int lanes = units - k;
      const S in = sigmoid(load_lanes<S>(gates + k, lanes));
      const S forget = sigmoid(load_lanes<S>(gates + units + k, lanes));
      const S candidate = tanh_activation(load_lanes<S>(gates + 2 * units + k, lanes));
      const S out = sigmoid(load_lanes<S>(gates + 3 * units + k, lanes));
      const S cell = fma(forget, load_lanes<S>(c + k, lanes), in * candidate);
      const S tanh_cell = tanh_activation(cell);
      store_lanes(in, lanes, gates + k);
      store_lanes(forget, lanes, gates + units + k);
      store_lanes(candidate, lanes, gates + 2 * units + k);
      store_lanes(out, lanes, gates + 3 * units + k);
      store_lanes(cell, lanes, next_c + k);
      store_lanes(tanh_cell, lanes, tanh_c + k);
      store_lanes(out * tanh_cell, lanes, h + k);
    }
    gates += 4 * units;
    c += units;
    next_c += units;
    tanh_c += units;
    h += units;
  }
}

template <typename S>
void lstm_backward(int samples, int units, Element<S>* gates, const Element<S>* c,
                   const Element<S>* tanh_c, const Element<S>* dh, Element<S>* dc) {
  const S one(Element<S>(1));
  for (int sample = 0; sample < samples; ++sample) {
    for (int k = 0; k < units; k += kWidth<S>) {
      const int lanes = units - k;
      const S in = load_lanes<S>(gates + k, lanes);
      const S forget = load_lanes<S>(gates + units + k, lanes);
      const S candidate = load_lanes<S>(gates + 2 * units + k, lanes);
      const S out = load_lanes<S>(gates + 3 * units + k, lanes);
      const S tanh_cell = load_lanes<S>(tanh_c + k, lanes);
      const S d_h = load_lanes<S>(dh + k, lanes);
      const S d = load_lanes<S>(dc + k, lanes) + d_h * out * (one - tanh_cell * tanh_cell);
      store_lanes(d * candidate * in * (one - in), lanes, gates + k);
      store_lanes(d * load_lanes<S>(c + k, lanes) * forget * (one - forget), lanes,
                  gates + units + k);
      store_lanes(d * in * (one - candidate * candidate), lanes, gates + 2 * units + k);
      store_lanes(d_h * tanh_cell * out * (one - out), lanes, gates + 3 * units + k);
      store_lanes(d * forget, lanes, dc + k);
    }
    gates += 4 * units;
    c += units;
    tanh_c += units;
    dh += units;
    dc += units;
  }
}

/// kRows x kPacks: the tile of the products.
template <typename S, int kRows, int kPacks>
constexpr Kernels<Element<S>> make_kernels() noexcept {
  return {&multiply<S, kRows, kPacks>, &add_gradient<S, kRows, kPacks>, &add_samples<S>,
          &lstm_forward<S>, &lstm_backward<S>};
}

}  // namespace sandrunner::learner::detail
