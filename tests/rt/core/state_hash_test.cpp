// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/state_hash.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "rt/core/controller.h"

namespace sandrunner {
namespace {

template <typename T>
std::uint64_t hash_of(const T& object) {
  StateHash hash;
  hash.add(object);
  return hash.value();
}

TEST(StateHashTest, ValueIsFixed) {
  // Recorded results name runs by this value: it must not change with compiler, machine or time.
  // Both numbers are from a computation in Python of what state_hash.h describes.
  EXPECT_EQ(StateHash{}.value(), 0x0748E3B729DC13ABu);
  EXPECT_EQ(hash_of(std::array<double, 3>{1.0, -2.5, 3.25}), 0x8E766BB48590D5A0u);
}

TEST(StateHashTest, EverySingleBitCounts) {
  std::array<std::uint64_t, 3> words{};
  std::set<std::uint64_t> values{hash_of(words)};
  for (auto& word : words) {
    for (int bit = 0; bit < 64; ++bit) {
      word ^= std::uint64_t{1} << bit;
      values.insert(hash_of(words));
      word ^= std::uint64_t{1} << bit;
    }
  }
  EXPECT_EQ(values.size(), 1u + 3u * 64u);
}

TEST(StateHashTest, OrderLengthAndSignOfZeroCount) {
  EXPECT_NE(hash_of(std::array<double, 2>{1.0, 2.0}), hash_of(std::array<double, 2>{2.0, 1.0}));
  EXPECT_NE(hash_of(std::array<double, 1>{}), hash_of(std::array<double, 2>{}));
  EXPECT_NE(hash_of(0.0), hash_of(-0.0));
}

TEST(StateHashTest, PartsGiveTheValueOfTheWhole) {
  const std::array<double, 2> whole{1.5, 2.5};
  StateHash hash;
  hash.add(whole[0]);
  hash.add(whole[1]);
  EXPECT_EQ(hash.value(), hash_of(whole));
}

TEST(StateHashTest, EqualControllersHashEqual) {
  const Controller a{ControllerConfig{}}, b{ControllerConfig{}};
  EXPECT_EQ(hash_of(a.state()), hash_of(b.state()));
}

}  // namespace
}  // namespace sandrunner
