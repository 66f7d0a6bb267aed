// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/mit/mit_models.h"

#include <algorithm>
#include <array>

namespace sandrunner {
namespace {

// position [rad], velocity [rad/s], torque [N m]
constexpr MitLimits limits(double position_rad, double velocity_radps, double torque_nm) noexcept {
  MitLimits result;
  result.position_rad = position_rad;
  result.velocity_radps = velocity_radps;
  result.torque_nm = result.reply_torque_nm = torque_nm;
  return result;
}

constexpr std::array kModels = {
    MitModel{"AK80-6 V1.0", MitVariant::kOriginal, limits(95.5, 45.0, 18.0)},
    MitModel{"AK80-6 V1.1", MitVariant::kOriginal, limits(12.5, 22.5, 12.0)},
    MitModel{"AK80-6 V2", MitVariant::kCubeMars, limits(12.5, 38.2, 12.0)},
    MitModel{"AK80-9 V1.1", MitVariant::kOriginal, limits(12.5, 22.5, 18.0)},
    MitModel{"AK80-9 V2", MitVariant::kCubeMars, limits(12.5, 25.64, 18.0)},
    MitModel{"AK70-10", MitVariant::kCubeMars, limits(12.5, 50.0, 24.0)},
    MitModel{"AK10-9", MitVariant::kCubeMars, limits(12.5, 50.0, 65.0)},
    MitModel{"DM4310", MitVariant::kDamiao, limits(12.5, 30.0, 10.0)},
    MitModel{"DM4310-48V", MitVariant::kDamiao, limits(12.5, 50.0, 10.0)},
    MitModel{"DM4340", MitVariant::kDamiao, limits(12.5, 10.0, 28.0)},
    MitModel{"DM6006", MitVariant::kDamiao, limits(12.5, 45.0, 20.0)},
    MitModel{"DM8006", MitVariant::kDamiao, limits(12.5, 45.0, 40.0)},
    MitModel{"DM8009", MitVariant::kDamiao, limits(12.5, 45.0, 54.0)},
    MitModel{"DM10010L", MitVariant::kDamiao, limits(12.5, 25.0, 200.0)},
};

}  // namespace

std::span<const MitModel> mit_models() noexcept { return kModels; }

const MitModel* find_mit_model(std::string_view name) noexcept {
  const auto* const found = std::find_if(kModels.begin(), kModels.end(),
                                         [&](const MitModel& model) { return model.name == name; });
  return found == kModels.end() ? nullptr : found;
}

}  // namespace sandrunner
