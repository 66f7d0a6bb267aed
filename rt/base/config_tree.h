// SPDX-License-Identifier: BSD-3-Clause
// Strict layered configuration from TOML. Layers are added from the weakest to the strongest
// (terrain preset or file < --hardware < --config < --set); a value is the one of the last layer
// that has its key.
//
//   ConfigTree config;
//   config.add_text(embedded_preset, "preset dry-sand");
//   config.add_file("my.toml");
//   config.set("terrain.friction=0.6");
//   const double friction = config.number("terrain.friction", 0.8, 0.0, 2.0);
//   config.reject_unknown();  // after everything was asked for
//
// All errors are InputErrors of one line that name origin, line, key, what was found and what was
// expected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sandrunner {

class ConfigTree {
 public:
  /// For `numbers`: an array of whatever length.
  static constexpr std::size_t kAnySize = std::numeric_limits<std::size_t>::max();

  ConfigTree();
  ~ConfigTree();
  ConfigTree(ConfigTree&&) noexcept;
  ConfigTree& operator=(ConfigTree&&) noexcept;

  /// Adds a layer of TOML text; `origin` names it in errors ("preset dry-sand").
  void add_text(std::string_view toml, const std::string& origin);
  /// Adds a layer from a file.
  void add_file(const std::string& path);
  /// Adds a layer of one "path.to.key=value". The value is TOML; a bare word that is no TOML value
  /// (dry-sand, runs/a.csv) is taken as a string. `option` names it in errors.
  void set(const std::string& assignment, const std::string& option = "--set");
  /// Adds a layer of one string, whatever is in it (a path of the command line). `option` names it
  /// in errors.
  void set_text(const std::string& path, const std::string& value, const std::string& option);

  /// The getters return the value of the strongest layer that has the dotted path, or the fallback,
  /// which is not checked. Ranges include their ends. Asking for a key makes it known to
  /// `reject_unknown` and `effective`. Integers are numbers too; nan and infinities are refused.
  double number(const std::string& path, double fallback, double min, double max);
  std::int64_t integer(const std::string& path, std::int64_t fallback, std::int64_t min,
                       std::int64_t max);
  bool flag(const std::string& path, bool fallback);
  std::string text(const std::string& path, const std::string& fallback);
  std::string choice(const std::string& path, const std::string& fallback,
                     const std::vector<std::string>& allowed);
  std::vector<double> numbers(const std::string& path, const std::vector<double>& fallback,
                              std::size_t expected_size, double min, double max);
  /// As many numbers as `fallback` has, or only the first `few` of them, which then repeat; with a
  /// `few` of 1 a number without an array.
  std::vector<double> repeated(const std::string& path, const std::vector<double>& fallback,
                               std::size_t few, double min, double max);
  /// The elements of an array of tables, taken whole from the strongest layer that has it; empty
  /// without one. What is asked of an element is known to this tree's `reject_unknown` and
  /// `effective`.
  std::vector<ConfigTree> tables(const std::string& path);

  /// Whether any layer has a value or table at the path. Does not make the key known.
  bool has(const std::string& path) const;

  /// Throws for the first key, in the weakest layer that has one, that was never asked for nor is
  /// among `also`; hints at the known key that was probably meant. Arrays of tables that a stronger
  /// layer replaced are not looked into.
  void reject_unknown(const std::set<std::string>& also = {}) const;

  /// TOML text, sorted, of every value asked for with the value that counted; as a single layer it
  /// gives the same configuration again. Fallbacks that are not finite stand for "none" and are
  /// left out.
  std::string effective() const;

 private:
  struct Layer;
  struct Record;
  struct Found;

  void add_layer(std::string_view toml, const std::string& origin, bool has_lines);
  Found find(const std::string& path) const;
  ConfigTree element(const Found& array, const std::string& path, std::size_t index,
                     const std::shared_ptr<Record>& record) const;
  std::string full_path(const std::string& path) const;
  [[noreturn]] void fail(const Found& found, const std::string& path,
                         const std::string& expected) const;

  std::vector<Layer> layers_;
  std::string prefix_;  ///< of an element of an array of tables, "segments[0].", for messages
  std::shared_ptr<Record> record_;  ///< shared by an element with the tree it came from
};

/// Keys and values, as TOML, of what ConfigTree::effective returned. Of an array of tables, which
/// has several lines, each line counts by itself.
std::map<std::string, std::string> settings_in(std::string_view effective);

}  // namespace sandrunner
