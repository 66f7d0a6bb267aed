// SPDX-License-Identifier: BSD-3-Clause
#include "sim/batch/batch.h"

#include <cstddef>
#include <cstring>
#include <new>
#include <stdexcept>

#include "rt/core/processor.h"

namespace sandrunner::sim {
namespace {

const detail::BatchKernel& kernel_of(BatchWidth width) {
  if (width == BatchWidth::kSixteen && !has_avx512())
    throw std::invalid_argument("this processor has no AVX-512: batch width 16");
  switch (width) {
    case BatchWidth::kOne:
      return detail::batch_kernel_x1();
    case BatchWidth::kEight:
      return detail::batch_kernel_x8();
    case BatchWidth::kSixteen:
      break;
  }
  return detail::batch_kernel_x16();
}

constexpr std::size_t kAlignment = 64;

template <typename Member>
std::size_t offset_of(Member BatchRobot<float>::* member) noexcept {
  static const BatchRobot<float> robot;
  return static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&(robot.*member)) -
                                  reinterpret_cast<const std::byte*>(&robot));
}

}  // namespace

BatchWidth best_batch_width() noexcept {
  return has_avx512() ? BatchWidth::kSixteen : BatchWidth::kEight;
}

void Batch::Free::operator()(std::byte* memory) const noexcept {
  ::operator delete[](memory, std::align_val_t(kAlignment));
}

Batch::Batch(int robots, const FootProfile<double>& foot, const StepSettings& settings,
             BatchWidth width)
    : robots_(robots),
      foot_(foot),
      settings_(settings),
      kernel_(kernel_of(width)),
      memory_(static_cast<std::byte*>(::operator new[](
          static_cast<std::size_t>(packs()) * kernel_.pack_bytes, std::align_val_t(kAlignment)))) {
  for (int p = 0; p < packs(); ++p) {
    kernel_.construct(memory_.get() + static_cast<std::size_t>(p) * kernel_.pack_bytes);
  }
}

std::byte* Batch::lane(int robot, std::size_t offset) const noexcept {
  return memory_.get() + static_cast<std::size_t>(robot / width()) * kernel_.pack_bytes +
         offset * static_cast<std::size_t>(width()) +
         static_cast<std::size_t>(robot % width()) * sizeof(float);
}

void Batch::copy_in(int robot, std::size_t offset, const void* values, std::size_t bytes) noexcept {
  const auto lanes = static_cast<std::size_t>(width());
  std::byte* const to = lane(robot, offset);
  for (std::size_t at = 0; at < bytes; at += sizeof(float)) {
    std::memcpy(to + at * lanes, static_cast<const std::byte*>(values) + at, sizeof(float));
  }
}

template <typename Value>
Value Batch::copy_out(int robot, std::size_t offset, std::size_t bytes) const noexcept {
  const auto lanes = static_cast<std::size_t>(width());
  const std::byte* const from = lane(robot, offset);
  Value v;
  for (std::size_t at = 0; at < bytes; at += sizeof(float)) {
    std::memcpy(reinterpret_cast<std::byte*>(&v) + at, from + at * lanes, sizeof(float));
  }
  return v;
}

void Batch::set_model(int robot, const RobotModel<float>& v) noexcept {
  copy_in(robot, offset_of(&BatchRobot<float>::model), &v, sizeof(v));
}
void Batch::set_terrain(int robot, const Terrain<float>& v) noexcept {
  copy_in(robot, offset_of(&BatchRobot<float>::terrain), &v, sizeof(v));
}
void Batch::set_heights(int robot, const HeightGrid* heights) { put(heights, robot, heights_); }
void Batch::set_footprints(int robot, Footprints* prints) { put(prints, robot, prints_); }
template <typename Pointer>
void Batch::put(Pointer pointer, int robot, std::vector<Pointer>& of_lanes) const {
  if (of_lanes.empty() && pointer == nullptr) return;
  of_lanes.resize(static_cast<std::size_t>(packs()) * static_cast<std::size_t>(width()));
  of_lanes[static_cast<std::size_t>(robot)] = pointer;
}
// Feet of one patch have no further ones to copy.
std::size_t Batch::state_bytes() const noexcept {
  return foot_.patches > 1 ? sizeof(RobotState<float>) : offsetof(RobotState<float>, further_feet);
}
void Batch::set_state(int robot, const RobotState<float>& v) noexcept {
  copy_in(robot, offset_of(&BatchRobot<float>::state), &v, state_bytes());
}
void Batch::set_drive(int robot, const BatchDrive<float>& v) noexcept {
  copy_in(robot, offset_of(&BatchRobot<float>::drive), &v, sizeof(v));
}
void Batch::set_robot(int robot, const BatchRobot<float>& v) noexcept {
  copy_in(robot, 0, &v, sizeof(v));
}
BatchRobot<float> Batch::robot(int robot) const noexcept {
  return copy_out<BatchRobot<float>>(robot, 0);
}
RobotState<float> Batch::state(int robot) const noexcept {
  return copy_out<RobotState<float>>(robot, offset_of(&BatchRobot<float>::state), state_bytes());
}
BatchSums<float> Batch::sums(int robot) const noexcept {
  return copy_out<BatchSums<float>>(robot, offset_of(&BatchRobot<float>::sums));
}
BatchReport<float> Batch::report(int robot) const noexcept {
  return copy_out<BatchReport<float>>(robot, offset_of(&BatchRobot<float>::report));
}

void Batch::advance(int pack, int ticks) noexcept {
  const auto of = [&](const auto& of_lanes) {
    return of_lanes.empty() ? nullptr
                            : of_lanes.data() + static_cast<std::ptrdiff_t>(pack) * width();
  };
  kernel_.advance(memory_.get() + static_cast<std::size_t>(pack) * kernel_.pack_bytes, foot_,
                  settings_, of(heights_), of(prints_), ticks);
}

}  // namespace sandrunner::sim
