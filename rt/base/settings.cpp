// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/settings.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

namespace sandrunner {
namespace {

constexpr std::pair<std::string_view, const char*> kUnits[] = {
    {"rad", "rad"},
    {"deg", "degrees"},
    {"degc", "degrees C"},
    {"radps", "rad/s"},
    {"radps2", "rad/s^2"},
    {"m", "m"},
    {"mps", "m/s"},
    {"mps2", "m/s^2"},
    {"s", "s"},
    {"ns", "N s"},
    {"nm", "N m"},
    {"nmprad", "N m/rad"},
    {"nmsprad", "N m s/rad"},
    {"nmprev", "N m/turn"},
    {"nmsprev", "N m s/turn"},
    {"nmpsqrtw", "N m/sqrt(W)"},
    {"npm", "N/m"},
    {"nspm", "N s/m"},
    {"npm3", "N/m^3"},
    {"pa", "Pa"},
    {"papm", "Pa/m"},
    {"kgpm3", "kg/m^3"},
    {"kgm2", "kg m^2"},
    {"w", "W"},
    {"v", "V"},
    {"hz", "Hz"},
    {"bps", "bit/s"},
    {"baud", "bit/s"},
    {"bytes", "bytes"},
    {"ticks", "ticks"},
    {"steps", "steps"},
};

}  // namespace

double degrees_of(double angle_rad) noexcept {
  const double degrees = angle_rad * (180.0 / std::numbers::pi);
  const double rounded = std::round(degrees * 1e9) / 1e9;
  return rounded * (std::numbers::pi / 180.0) == angle_rad ? rounded : degrees;
}

std::string setting_path(const std::string& table, const char* key) {
  return table.empty() ? std::string(key) : table + "." + key;
}

std::string unit_of(const std::string& key) {
  const std::string_view ending = std::string_view(key).substr(key.find_last_of("_.") + 1);
  for (const auto& [suffix, unit] : kUnits) {
    if (suffix == ending) return unit;
  }
  return {};
}

std::string setting_text(double value) {
  std::string text = fmt::format("{:g}", value);
  if (std::stod(text) != value) text = fmt::format("{}", value);
  // 1e+09 -> 1e9
  if (const auto exponent = text.find("e+"); exponent != std::string::npos) {
    text.erase(exponent + 1, text[exponent + 2] == '0' ? 2 : 1);
  }
  if (const auto exponent = text.find("e-0"); exponent != std::string::npos) {
    text.erase(exponent + 2, 1);
  }
  return text;
}

std::string setting_text(bool value) { return value ? "true" : "false"; }

std::string setting_text(const std::string& value) { return value.empty() ? "\"\"" : value; }

std::string range_text(double min, double max) {
  return fmt::format("{} to {}", setting_text(min), setting_text(max));
}

}  // namespace sandrunner
