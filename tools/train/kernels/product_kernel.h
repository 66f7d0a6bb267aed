// SPDX-License-Identifier: BSD-3-Clause
// Matrix products on packs; included by the source of each instruction set. A tile of C stays in
// registers while the sum runs: kRows x kPacks packs, for every step of which kPacks packs of B are
// loaded and kRows elements of A broadcast.
#pragma once

#include <algorithm>
#include <utility>

#include "sim/lanes/pack.h"
#include "tools/train/kernels/kernels.h"

namespace sandrunner::learner::detail {

// For double; packs bring theirs.
using sim::fma, sim::load, sim::select, sim::store;

template <typename S>
struct ElementOf {
  using type = S;
};
template <int kLanes>
struct ElementOf<sim::Pack<kLanes>> {
  using type = float;
};
template <typename S>
using Element = typename ElementOf<S>::type;
template <typename S>
inline constexpr int kWidth = static_cast<int>(sizeof(S) / sizeof(Element<S>));

/// Samples whose part of a panel of B is packed at a time: 32 KiB of float.
inline constexpr int kSampleBlock = 256;

/// A tile and what it is made from.
template <typename E>
struct Tile {
  int depth = 0;
  const E* a = nullptr;  ///< element (i, k) at i a_stride + k, or, "across", at k a_stride + i
  std::ptrdiff_t a_stride = 0;
  const E* b = nullptr;      ///< of a panel
  const E* start = nullptr;  ///< one value a column; none: what C holds
  E* c = nullptr;
  std::ptrdiff_t c_stride = 0;
  int columns = 0;  ///< of C that exist
  Finish finish = Finish::kNone;
  const E* activated = nullptr;
  std::ptrdiff_t activated_stride = 0;
};

/// Calls f(row, pack) for all of a tile, written out: only so do compilers keep an array in
/// registers.
template <int kRows, int kPacks, typename F>
[[gnu::always_inline]] inline void for_each(const F& f) {
  const auto all =
      [&]<int... kIndex>(std::integer_sequence<int, kIndex...>)
          __attribute__((always_inline)) { (f(kIndex / kPacks, kIndex % kPacks), ...); };
  all(std::make_integer_sequence<int, kRows * kPacks>());
}

template <typename S, int kRows, int kPacks, bool kAcross>
[[gnu::noinline]] void compute_tile(const Tile<Element<S>>& t) {
  using E = Element<S>;
  S sum[kRows][kPacks];
  E* const c = t.c;
  const std::ptrdiff_t c_stride = t.c_stride;
  if (t.start != nullptr) {
    const E* const start = t.start;
    for_each<kRows, kPacks>([&](int i, int p) { load(start + p * kWidth<S>, sum[i][p]); });
  } else {
    for_each<kRows, kPacks>(
        [&](int i, int p) { load(c + i * c_stride + p * kWidth<S>, sum[i][p]); });
  }

  const E* a = t.a;
  const E* b = t.b;
  const std::ptrdiff_t a_stride = t.a_stride;
  for (int k = 0; k < t.depth; ++k) {
    S factor[kPacks];
    for_each<1, kPacks>([&](int, int p) { load(b + p * kWidth<S>, factor[p]); });
    for_each<kRows, kPacks>([&](int i, int p) {
      sum[i][p] = fma(S(kAcross ? a[i] : a[i * a_stride + k]), factor[p], sum[i][p]);
    });
    if constexpr (kAcross) a += a_stride;
    b += kPanelColumns;
  }

  const S zero(E(0)), slope(kLeakySlope<E>);
  if (t.finish == Finish::kLeakyRelu) {
    for_each<kRows, kPacks>([&](int i, int p) {
      const S x = sum[i][p];
      store(select(x > zero, x, slope * x), c + i * c_stride + p * kWidth<S>);
    });
  } else if (t.finish == Finish::kLeakyReluBackward) {
    const E* const activated = t.activated;
    const std::ptrdiff_t activated_stride = t.activated_stride;
    for_each<kRows, kPacks>([&](int i, int p) {
      const S x = sum[i][p];
      S y;
      load(activated + i * activated_stride + p * kWidth<S>, y);
      store(select(y > zero, x, slope * x), c + i * c_stride + p * kWidth<S>);
    });
  } else {
    for_each<kRows, kPacks>(
        [&](int i, int p) { store(sum[i][p], c + i * c_stride + p * kWidth<S>); });
  }
}

/// A tile past the edge of C, made on a copy.
template <typename S, int kRows, int kPacks, bool kAcross>
[[gnu::noinline]] void compute_edge_tile(const Tile<Element<S>>& t) {
  using E = Element<S>;
  constexpr int kColumns = kPacks * kWidth<S>;
  alignas(64) E c[kRows][kColumns];
  alignas(64) E activated[kRows][kColumns];
  const auto copy_in = [&](const E* from, std::ptrdiff_t stride, E(&to)[kRows][kColumns]) {
    for (int i = 0; i < kRows; ++i) {
      std::fill(std::copy_n(from + i * stride, t.columns, to[i]), std::end(to[i]), E(0));
    }
  };
  if (t.start == nullptr) copy_in(t.c, t.c_stride, c);
  if (t.activated != nullptr) copy_in(t.activated, t.activated_stride, activated);
  Tile<E> whole = t;
  whole.c = c[0];
  whole.activated = activated[0];
  whole.c_stride = whole.activated_stride = kColumns;
  compute_tile<S, kRows, kPacks, kAcross>(whole);
  for (int i = 0; i < kRows; ++i) std::copy_n(c[i], t.columns, t.c + i * t.c_stride);
}

/// A tile of `rows` <= kRows rows.
template <typename S, int kRows, int kPacks, bool kAcross>
inline void compute_rows(int rows, const Tile<Element<S>>& tile) {
  if constexpr (kRows > 1) {
    if (rows < kRows) return compute_rows<S, kRows - 1, kPacks, kAcross>(rows, tile);
  }
  constexpr int kColumns = kPacks * kWidth<S>;  // of one there is no edge
  if (kColumns == 1 || tile.columns >= kColumns) {
    compute_tile<S, kRows, kPacks, kAcross>(tile);
  } else if constexpr (kColumns > 1) {
    compute_edge_tile<S, kRows, kPacks, kAcross>(tile);
  }
}

/// `rows` rows by the columns of a panel that exist; `t` is at the first of both.
template <typename S, int kRows, int kPacks, bool kAcross>
void compute_panel(int rows, Tile<Element<S>> t) {
  const Tile<Element<S>> first = t;
  for (int lane = 0; lane < first.columns; lane += kPacks * kWidth<S>) {
    t.a = first.a;
    t.b = first.b + lane;
    if (first.start != nullptr) t.start = first.start + lane;
    t.c = first.c + lane;
    if (first.activated != nullptr) t.activated = first.activated + lane;
    t.columns = first.columns - lane;
    for (int left = rows; left > 0; left -= kRows) {
      if (t.columns <= kWidth<S>) {
        compute_rows<S, kRows, 1, kAcross>(std::min(kRows, left), t);
      } else {
        compute_rows<S, kRows, kPacks, kAcross>(std::min(kRows, left), t);
      }
      t.a += kAcross ? kRows : kRows * t.a_stride;
      t.c += kRows * t.c_stride;
      if (t.activated != nullptr) t.activated += kRows * t.activated_stride;
    }
  }
}

template <typename S, int kRows, int kPacks>
void multiply(const Product<Element<S>>& p) {
  for (int first = 0; first < p.b.columns(); first += kPanelColumns) {
    const Element<S>* panel = p.b.panel(first);
    Tile<Element<S>> tile;
    tile.depth = p.b.depth();
    tile.a = p.a.data;
    tile.a_stride = p.a.stride;
    tile.b = panel + kPanelColumns;
    tile.start = p.add ? nullptr : panel;
    tile.c = p.c.data + first;
    tile.c_stride = p.c.stride;
    tile.finish = p.finish;
    if (p.activated.data != nullptr) tile.activated = p.activated.data + first;
    tile.activated_stride = p.activated.stride;
    tile.columns = std::min(kPanelColumns, p.b.columns() - first);
    compute_panel<S, kRows, kPacks, false>(p.samples, tile);
  }
}

/// A row of a panel of B, zero past its last column.
template <typename S>
inline void copy_row(const Element<S>* from, int columns, Element<S> (&to)[kPanelColumns]) {
  if (columns < kPanelColumns) {
    std::fill(std::copy_n(from, columns, to), std::end(to), Element<S>(0));
    return;
  }
  for (int lane = 0; lane < kPanelColumns; lane += kWidth<S>) {
    S s;
    load(from + lane, s);
    store(s, to + lane);
  }
}

template <typename S, int kRows, int kPacks>
void add_gradient(const GradientProduct<Element<S>>& p) {
  using E = Element<S>;
  alignas(64) E panel[kSampleBlock][kPanelColumns];
  for (int sample = 0; sample < p.samples; sample += kSampleBlock) {
    const int depth = std::min(kSampleBlock, p.samples - sample);
    for (int first = 0; first < p.columns; first += kPanelColumns) {
      const int columns = std::min(kPanelColumns, p.columns - first);
      const E* b = p.b.data + sample * p.b.stride + first;
      for (int k = 0; k < depth; ++k, b += p.b.stride) copy_row<S>(b, columns, panel[k]);
      Tile<E> tile;
      tile.depth = depth;
      tile.a = p.a.data + sample * p.a.stride;
      tile.a_stride = p.a.stride;
      tile.b = panel[0];
      tile.c = p.c.data + first;
      tile.c_stride = p.c.stride;
      tile.columns = columns;
      compute_panel<S, kRows, kPacks, true>(p.rows, tile);
    }
  }
}

/// sum + all rows of x, of kPacks packs of columns.
template <typename S, int kPacks>
inline void add_columns(int samples, Rows<const Element<S>> x, Element<S>* sum) {
  S total[kPacks], term;
  for (int p = 0; p < kPacks; ++p) load(sum + p * kWidth<S>, total[p]);
  for (int i = 0; i < samples; ++i) {
    for (int p = 0; p < kPacks; ++p) {
      load(x.data + i * x.stride + p * kWidth<S>, term);
      total[p] = total[p] + term;
    }
  }
  for (int p = 0; p < kPacks; ++p) store(total[p], sum + p * kWidth<S>);
}

template <typename S>
void add_samples(int samples, int columns, Rows<const Element<S>> x, Element<S>* sum) {
  constexpr int kPacks = 4;
  int first = 0;
  for (; first + kPacks * kWidth<S> <= columns; first += kPacks * kWidth<S>) {
    add_columns<S, kPacks>(samples, {x.data + first, x.stride}, sum + first);
  }
  for (; first < columns; ++first) {
    for (int i = 0; i < samples; ++i) sum[first] += x.data[i * x.stride + first];
  }
}

}  // namespace sandrunner::learner::detail
