// SPDX-License-Identifier: BSD-3-Clause
// Settings as tables: a row says key, member, range and meaning of one setting. The same rows are
// read from a configuration and listed for the reference that `sandrunner --settings` prints.
//
//   constexpr Setting<DdsConfig> kDds[] = {
//       {"enabled", &DdsConfig::enabled, "Publish telemetry over DDS."},
//       {"ros_hz", &DdsConfig::ros_hz, 1, 200, "Rate of the ROS 2 topics."},
//       {"cmd_vel", words<&DdsConfig::stamped_cmd_vel>(kTypes), "Type of rt/cmd_vel."},
//   };
//   read_settings(config, "dds", kDds, dds);  // keys that are not given leave `dds` as it is
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rt/base/config_tree.h"

namespace sandrunner {

/// An angle that is kept in rad and set in degrees.
template <typename Settings>
struct DegreesSetting {
  constexpr explicit DegreesSetting(double Settings::* member_rad) noexcept : member(member_rad) {}
  double Settings::* member;
};
template <typename Settings>
constexpr DegreesSetting<Settings> degrees(double Settings::* member_rad) noexcept {
  return DegreesSetting<Settings>(member_rad);
}

/// An array of which a file may give only the first `kFew` numbers, which then repeat: one number
/// for three joints that are alike, three for four legs that are.
template <typename Settings, std::size_t kSize, std::size_t kFew>
struct RepeatedSetting {
  std::array<double, kSize> Settings::* member;
};
template <std::size_t kFew, typename Settings, std::size_t kSize>
constexpr RepeatedSetting<Settings, kSize, kFew> repeated(
    std::array<double, kSize> Settings::* array) noexcept {
  return {array};
}

/// One of some words, in the order of an enum's values; of a bool, those for false and true.
template <typename Settings>
struct WordSetting {
  std::span<const char* const> words;
  int (*get)(const Settings&) noexcept;
  void (*set)(Settings&, int) noexcept;
};
template <typename Settings, typename Value>
Settings settings_of(Value Settings::*);  // its type alone is used
template <auto kMember, typename Settings = decltype(settings_of(kMember))>
constexpr WordSetting<Settings> words(std::span<const char* const> names) noexcept {
  using Value = std::remove_reference_t<decltype(std::declval<Settings&>().*kMember)>;
  return {names, [](const Settings& s) noexcept { return static_cast<int>(s.*kMember); },
          [](Settings& s, int i) noexcept { s.*kMember = static_cast<Value>(i); }};
}

// Defaults in words: of a setting that must be given, and of one that the robot's file gives.
inline constexpr const char* kRequired = "required";
inline constexpr const char* kFromRobotFile = "from the robot file";

/// One setting of a configuration table.
template <typename Settings>
struct Setting {
  using Member =
      std::variant<double Settings::*, int Settings::*, unsigned Settings::*,
                   std::uint16_t Settings::*, std::uint64_t Settings::*, bool Settings::*,
                   std::string Settings::*, std::array<double, 3> Settings::*,
                   RepeatedSetting<Settings, 3, 1>, RepeatedSetting<Settings, 12, 3>,
                   DegreesSetting<Settings>, WordSetting<Settings>>;

  /// A number, or an array of three, each from `least` to `most`. `default_words` and `range_words`
  /// say in the reference what depends on other files.
  constexpr Setting(const char* key_text, Member where, double least, double most,
                    const char* what = "", const char* default_words = nullptr,
                    const char* range_words = nullptr)
      : key(key_text),
        member(where),
        min(least),
        max(most),
        meaning(what),
        fallback(default_words),
        range(range_words) {}
  /// Anything else.
  constexpr Setting(const char* key_text, Member where, const char* what,
                    const char* default_words = nullptr)
      : key(key_text), member(where), meaning(what), fallback(default_words) {}

  const char* key;
  Member member;
  double min = 0.0, max = 0.0;
  const char* meaning;
  const char* fallback = nullptr;
  const char* range = nullptr;

  /// read_setting() leaves it to its caller to refuse a configuration without it.
  constexpr bool required() const noexcept { return fallback == kRequired; }
};

/// For numbers without an upper limit of their own.
inline constexpr double kNoLimit = 1e9;

/// Degrees of an angle as short as they convert back: 60, not 59.99999999999999.
double degrees_of(double angle_rad) noexcept;

/// "table.key"; without a table "key".
std::string setting_path(const std::string& table, const char* key);

/// Numbers that a setting of an array needs at least; 0: it is no RepeatedSetting.
template <typename Member>
inline constexpr std::size_t kFewOf = 0;
template <typename Settings, std::size_t kSize, std::size_t kFew>
inline constexpr std::size_t kFewOf<RepeatedSetting<Settings, kSize, kFew>> = kFew;

/// Reads one row. Throws InputError for a value out of its range.
template <typename Settings>
void read_setting(ConfigTree& config, const std::string& path, const Setting<Settings>& row,
                  Settings& settings) {
  const auto read = [&]<typename Member>(const Member& member) {
    if constexpr (std::is_same_v<Member, WordSetting<Settings>>) {
      const std::vector<std::string> names(member.words.begin(), member.words.end());
      const std::string word =
          config.choice(path, names[static_cast<std::size_t>(member.get(settings))], names);
      int index = 0;
      while (names[static_cast<std::size_t>(index)] != word) ++index;
      member.set(settings, index);
    } else if constexpr (std::is_same_v<Member, DegreesSetting<Settings>>) {
      double& angle_rad = settings.*member.member;
      angle_rad =
          config.number(path, degrees_of(angle_rad), row.min, row.max) * (std::numbers::pi / 180.0);
    } else if constexpr (kFewOf<Member> > 0) {
      auto& value = settings.*member.member;
      const std::vector<double> numbers =
          config.repeated(path, {value.begin(), value.end()}, kFewOf<Member>, row.min, row.max);
      std::copy(numbers.begin(), numbers.end(), value.begin());
    } else {
      auto& value = settings.*member;
      using Value = std::remove_reference_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, bool>) {
        value = config.flag(path, value);
      } else if constexpr (std::is_same_v<Value, std::string>) {
        value = config.text(path, value);
      } else if constexpr (std::is_same_v<Value, double>) {
        value = config.number(path, value, row.min, row.max);
      } else if constexpr (std::is_integral_v<Value>) {
        value = static_cast<Value>(config.integer(path, static_cast<std::int64_t>(value),
                                                  static_cast<std::int64_t>(row.min),
                                                  static_cast<std::int64_t>(row.max)));
      } else {
        const std::vector<double> numbers =
            config.numbers(path, {value.begin(), value.end()}, value.size(), row.min, row.max);
        std::copy(numbers.begin(), numbers.end(), value.begin());
      }
    }
  };
  std::visit(read, row.member);
}

/// Rows of one kind, in a container of any type.
template <typename Settings>
using SettingRows = std::type_identity_t<std::span<const Setting<Settings>>>;

/// Reads all rows of a table; keys that are not given leave `settings` as it is. Throws InputError.
template <typename Settings>
void read_settings(ConfigTree& config, const std::string& table, SettingRows<Settings> rows,
                   Settings& settings) {
  for (const Setting<Settings>& row : rows) {
    read_setting(config, setting_path(table, row.key), row, settings);
  }
}

/// A line of the reference, as text.
struct SettingLine {
  std::string key, fallback, unit, range, meaning;
};

/// Unit that the name of a number's key ends with: "N m/rad" of "kp_nmprad"; empty: none.
std::string unit_of(const std::string& key);

/// Texts of defaults and ranges. Numbers are short but convert back.
std::string setting_text(double value);
std::string setting_text(bool value);
std::string setting_text(const std::string& value);
std::string range_text(double min, double max);

/// The line of a row, with the default that default-constructed settings have.
template <typename Settings>
SettingLine setting_line(const std::string& table, const Setting<Settings>& row) {
  const Settings defaults{};
  SettingLine line{.key = setting_path(table, row.key),
                   .fallback = {},
                   .unit = unit_of(row.key),
                   .range = range_text(row.min, row.max),
                   .meaning = row.meaning};
  const auto describe = [&]<typename Member>(const Member& member) {
    if constexpr (std::is_same_v<Member, WordSetting<Settings>>) {
      line.fallback = member.words[static_cast<std::size_t>(member.get(defaults))];
      line.unit.clear();
      line.range.clear();
      for (const char* const word : member.words) {
        line.range += (line.range.empty() ? "" : ", ") + std::string(word);
      }
    } else if constexpr (std::is_same_v<Member, DegreesSetting<Settings>>) {
      line.fallback = setting_text(degrees_of(defaults.*member.member));
    } else if constexpr (kFewOf<Member> > 0) {
      line.fallback = setting_text((defaults.*member.member)[0]);
    } else {
      const auto& value = defaults.*member;
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, bool>) {
        line.unit.clear();
        line.range = "true, false";
        line.fallback = setting_text(value);
      } else if constexpr (std::is_same_v<Value, std::string>) {
        line.unit.clear();
        line.range.clear();
        line.fallback = setting_text(value);
      } else if constexpr (std::is_arithmetic_v<Value>) {
        line.fallback = setting_text(static_cast<double>(value));
      } else {
        for (const double number : value) {
          line.fallback += (line.fallback.empty() ? "[" : ", ") + setting_text(number);
        }
        line.fallback += "]";
      }
    }
  };
  std::visit(describe, row.member);
  if (row.fallback != nullptr) line.fallback = row.fallback;
  if (row.range != nullptr) line.range = row.range;
  return line;
}

/// Lists all rows of a table, whose settings may be of several structs.
template <typename... Rows>
void list_settings(std::vector<SettingLine>& lines, const std::string& table, const Rows&... rows) {
  const auto list = [&](const auto& of_struct) {
    for (const auto& row : of_struct) lines.push_back(setting_line(table, row));
  };
  (list(rows), ...);
}

}  // namespace sandrunner
