// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/config_tree.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/likely_meant.h"
#include "rt/base/toml_depth.h"
#include "rt/base/toml_text.h"

namespace sandrunner {

/// One source of values. Layers are never merged: copies of toml++ nodes lose their line numbers.
struct ConfigTree::Layer {
  std::shared_ptr<const toml::table> table;
  std::string origin;
  bool has_lines = true;

  std::string where(const toml::node& node) const {
    return has_lines ? fmt::format("{}:{}", origin, node.source().begin.line) : origin;
  }
};

/// What was asked for, by path: the value that counted, as TOML.
struct ConfigTree::Record {
  struct Tables {
    const toml::array* source = nullptr;
    std::vector<std::shared_ptr<Record>> elements;
  };
  std::map<std::string, std::string> values;  ///< empty text: none
  std::map<std::string, Tables> tables;

  std::map<std::string, std::string> entries() const {
    std::map<std::string, std::string> all;
    for (const auto& [path, value] : values) {
      if (!value.empty()) all[path] = value;
    }
    for (const auto& [path, array] : tables) {
      std::string text = "[";
      for (const auto& element : array.elements) {
        std::string pairs;
        for (const auto& [key, value] : element->entries()) {
          pairs += (pairs.empty() ? "" : ", ") + key + " = " + value;
        }
        text += "\n  {" + pairs + "},";
      }
      all[path] = text + (array.elements.empty() ? "]" : "\n]");
    }
    return all;
  }
};

struct ConfigTree::Found {
  const Layer* layer = nullptr;
  const toml::node* node = nullptr;
};

namespace {

constexpr std::string_view kBareWordCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./~+:@";

template <typename T>
std::string describe_range(const std::string& noun, T min, T max) {
  const bool has_min = min > std::numeric_limits<T>::lowest();
  const bool has_max = max < std::numeric_limits<T>::max();
  if (has_min && has_max) return fmt::format("{} from {} to {}", noun, min, max);
  if (has_min) return fmt::format("{} of at least {}", noun, min);
  if (has_max) return fmt::format("{} of at most {}", noun, max);
  return noun;
}

using Key = std::pair<std::string, const toml::node*>;

/// All values (and empty tables) of a table with their dotted paths; does not look into what
/// `is_known(path)`.
template <typename IsKnown>
void collect_unknown(const toml::table& table, const std::string& prefix, const IsKnown& is_known,
                     std::vector<Key>& unknown) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + key_text(key.str());
    if (is_known(path)) continue;
    const toml::table* child = node.as_table();
    if (child != nullptr && !child->empty()) {
      collect_unknown(*child, path + ".", is_known, unknown);
    } else {
      unknown.emplace_back(path, &node);
    }
  }
}

}  // namespace

ConfigTree::ConfigTree() : record_(std::make_shared<Record>()) {}
ConfigTree::~ConfigTree() = default;
ConfigTree::ConfigTree(ConfigTree&&) noexcept = default;
ConfigTree& ConfigTree::operator=(ConfigTree&&) noexcept = default;

void ConfigTree::add_layer(std::string_view toml, const std::string& origin, bool has_lines) {
  if (toml.size() > kMostTomlBytes) {
    throw InputError(one_line(fmt::format("{}: found {} bytes, expected at most {} of TOML", origin,
                                          toml.size(), kMostTomlBytes)));
  }
  if (const TomlDepth found = find_too_deep(toml); found.line != 0) {
    throw InputError(one_line(fmt::format(
        "{}{}: {}", origin, has_lines ? fmt::format(":{}", found.line) : "", found.problem)));
  }
  try {
    layers_.push_back(
        {std::make_shared<const toml::table>(toml::parse(toml, origin)), origin, has_lines});
  } catch (const toml::parse_error& error) {
    const std::string line = has_lines ? fmt::format(":{}", error.source().begin.line) : "";
    throw InputError(
        one_line(fmt::format("{}{}: not valid TOML: {}", origin, line, error.description())));
  }
}

void ConfigTree::add_text(std::string_view toml, const std::string& origin) {
  add_layer(toml, origin, true);
}

void ConfigTree::add_file(const std::string& path) {
  add_layer(read_input_file(path, "a TOML file"), path, true);
}

void ConfigTree::set(const std::string& assignment, const std::string& option) {
  const std::size_t equals = assignment.find('=');
  const std::string path = assignment.substr(0, equals);
  if (equals == std::string::npos ||
      path.find_first_not_of(kTomlPathCharacters) != std::string::npos) {
    throw InputError(
        one_line(fmt::format("{}: found '{}', expected path.to.key=value", option, assignment)));
  }
  const std::string value = assignment.substr(equals + 1);
  const bool bare_word =
      !value.empty() && value.find_first_not_of(kBareWordCharacters) == std::string::npos;
  // A line break would let further keys in.
  const bool one_value = value.find_first_of("\r\n") == std::string::npos;
  try {
    if (one_value) return add_layer(path + " = " + value, option, false);
  } catch (const InputError&) {
    // perhaps a bare word
  }
  if (!bare_word) {
    throw InputError(one_line(
        fmt::format("{}: {}: found '{}', expected a TOML value (strings in quotes unless one word)",
                    option, path, value)));
  }
  set_text(path, value, option);
}

void ConfigTree::set_text(const std::string& path, const std::string& value,
                          const std::string& option) {
  add_layer(path + " = " + toml_quoted(value), option, false);
}

ConfigTree::Found ConfigTree::find(const std::string& path) const {
  for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
    const toml::node* node = layer->table.get();
    for (std::size_t begin = 0; node != nullptr && begin <= path.size();) {
      const std::size_t end = std::min(path.find('.', begin), path.size());
      const toml::table* table = node->as_table();
      node = table == nullptr ? nullptr
                              : table->get(std::string_view(path).substr(begin, end - begin));
      begin = end + 1;
    }
    if (node != nullptr) return {&*layer, node};
  }
  return {};
}

std::string ConfigTree::full_path(const std::string& path) const { return prefix_ + path; }

void ConfigTree::fail(const Found& found, const std::string& path,
                      const std::string& expected) const {
  throw InputError(
      one_line(fmt::format("{}: {}: found {}, expected {}", found.layer->where(*found.node),
                           full_path(path), describe(*found.node), expected)));
}

double ConfigTree::number(const std::string& path, double fallback, double min, double max) {
  double result = fallback;
  if (const Found found = find(path); found.node != nullptr) {
    const std::optional<double> value = number_in(*found.node, min, max);
    if (!value) fail(found, path, describe_range("a finite number", min, max));
    result = *value;
  }
  record_->values[path] = std::isfinite(result) ? toml_text(result) : std::string();
  return result;
}

std::int64_t ConfigTree::integer(const std::string& path, std::int64_t fallback, std::int64_t min,
                                 std::int64_t max) {
  std::int64_t result = fallback;
  if (const Found found = find(path); found.node != nullptr) {
    const auto* value = found.node->as_integer();
    if (value == nullptr || value->get() < min || value->get() > max) {
      fail(found, path, describe_range("a whole number", min, max));
    }
    result = value->get();
  }
  record_->values[path] = std::to_string(result);
  return result;
}

bool ConfigTree::flag(const std::string& path, bool fallback) {
  bool result = fallback;
  if (const Found found = find(path); found.node != nullptr) {
    const auto* value = found.node->as_boolean();
    if (value == nullptr) fail(found, path, "true or false");
    result = value->get();
  }
  record_->values[path] = result ? "true" : "false";
  return result;
}

std::string ConfigTree::text(const std::string& path, const std::string& fallback) {
  std::string result = fallback;
  if (const Found found = find(path); found.node != nullptr) {
    const auto* value = found.node->as_string();
    if (value == nullptr) fail(found, path, "a string");
    result = value->get();
  }
  record_->values[path] = toml_text(result);
  return result;
}

std::string ConfigTree::choice(const std::string& path, const std::string& fallback,
                               const std::vector<std::string>& allowed) {
  const Found found = find(path);
  if (found.node != nullptr) {
    const std::optional<std::string> value = found.node->value<std::string>();
    if (!value || std::find(allowed.begin(), allowed.end(), *value) == allowed.end()) {
      fail(found, path, fmt::format("one of \"{}\"", fmt::join(allowed, "\", \"")));
    }
  }
  return text(path, fallback);
}

std::vector<double> ConfigTree::numbers(const std::string& path,
                                        const std::vector<double>& fallback,
                                        std::size_t expected_size, double min, double max) {
  std::vector<double> result = fallback;
  if (const Found found = find(path); found.node != nullptr) {
    const std::string size =
        expected_size == kAnySize ? std::string() : fmt::format("{} ", expected_size);
    const std::string expected =
        describe_range(fmt::format("an array of {}finite numbers", size), min, max);
    const toml::array* array = found.node->as_array();
    if (array == nullptr || (expected_size != kAnySize && array->size() != expected_size)) {
      fail(found, path, expected);
    }
    result.clear();
    for (const toml::node& element : *array) {
      const std::optional<double> value = number_in(element, min, max);
      if (!value) {
        fail({found.layer, &element}, fmt::format("{}[{}]", path, result.size()), expected);
      }
      result.push_back(*value);
    }
  }
  record_->values[path] = toml_text(std::span<const double>(result));
  return result;
}

std::vector<double> ConfigTree::repeated(const std::string& path,
                                         const std::vector<double>& fallback, std::size_t few,
                                         double min, double max) {
  std::vector<double> result = fallback;
  const std::size_t all = fallback.size();
  if (const Found found = find(path); found.node != nullptr) {
    const std::string one = describe_range("a finite number", min, max);
    const std::string several =
        describe_range(fmt::format("an array of {} finite numbers", few), min, max);
    const std::string expected =
        fmt::format("{}, or {} {}", few == 1 ? one : several, few == 1 ? "an array of" : "of", all);
    std::vector<double> given;
    const auto add = [&](const toml::node& node, const std::string& where) {
      const std::optional<double> value = number_in(node, min, max);
      if (!value) fail({found.layer, &node}, where, expected);
      given.push_back(*value);
    };
    if (const toml::array* array = found.node->as_array(); array == nullptr) {
      if (few != 1) fail(found, path, expected);
      add(*found.node, path);
    } else if (array->size() == all || (few != 1 && array->size() == few)) {
      for (const toml::node& node : *array) add(node, fmt::format("{}[{}]", path, given.size()));
    } else {
      fail(found, path, expected);
    }
    for (std::size_t i = 0; i < all; ++i) result[i] = given[i % given.size()];
  }
  // As short as it can be given.
  std::size_t size = few;
  for (std::size_t i = few; i < all; ++i) {
    if (result[i] != result[i % few]) size = all;
  }
  std::string text = toml_text(std::span<const double>(result).first(size));
  if (size == 1 && !text.empty()) text = text.substr(1, text.size() - 2);  // without an array
  record_->values[path] = text;
  return result;
}

std::vector<ConfigTree> ConfigTree::tables(const std::string& path) {
  const Found found = find(path);
  const toml::array* array = nullptr;
  if (found.node != nullptr) {
    array = found.node->as_array();
    if (array == nullptr) fail(found, path, "an array of tables");
    for (const toml::node& element : *array) {
      if (!element.is_table()) fail({found.layer, &element}, path, "an array of tables");
    }
  }
  Record::Tables& record = record_->tables[path];
  const std::size_t size = array == nullptr ? 0 : array->size();
  if (record.source != array || record.elements.size() != size) {
    record = {array, {}};
    for (std::size_t i = 0; i < size; ++i) record.elements.push_back(std::make_shared<Record>());
  }
  std::vector<ConfigTree> elements;
  for (std::size_t i = 0; i < size; ++i) {
    elements.push_back(element(found, path, i, record.elements[i]));
  }
  return elements;
}

ConfigTree ConfigTree::element(const Found& array, const std::string& path, std::size_t index,
                               const std::shared_ptr<Record>& record) const {
  ConfigTree element;
  // Keeps the whole layer alive, points at the element.
  const std::shared_ptr<const toml::table> table(array.layer->table,
                                                 (*array.node->as_array())[index].as_table());
  element.layers_.push_back({table, array.layer->origin, array.layer->has_lines});
  element.prefix_ = fmt::format("{}[{}].", full_path(path), index);
  element.record_ = record;
  return element;
}

bool ConfigTree::has(const std::string& path) const { return find(path).node != nullptr; }

void ConfigTree::reject_unknown(const std::set<std::string>& also) const {
  std::vector<std::string> known(also.begin(), also.end());
  for (const auto& [path, text] : record_->values) known.push_back(path);
  for (const auto& [path, tables] : record_->tables) known.push_back(path);
  const auto is_known = [&](const std::string& path) {
    return record_->values.contains(path) || record_->tables.contains(path) || also.contains(path);
  };
  for (const Layer& layer : layers_) {
    std::vector<Key> unknown;
    collect_unknown(*layer.table, "", is_known, unknown);
    std::sort(unknown.begin(), unknown.end(), [](const Key& a, const Key& b) {
      return a.second->source().begin < b.second->source().begin;
    });
    for (const auto& [path, node] : unknown) {
      const std::string inside = path + ".";
      const bool is_table = std::any_of(known.begin(), known.end(), [&](const std::string& key) {
        return key.compare(0, inside.size(), inside) == 0;
      });
      if (is_table && node->is_table()) continue;  // an empty one
      if (is_table) fail({&layer, node}, path, "a table");
      const std::string meant = likely_meant(path, known);
      throw InputError(
          one_line(fmt::format("{}: unknown key '{}'{}", layer.where(*node), full_path(path),
                               meant.empty() ? "" : ", did you mean '" + full_path(meant) + "'?")));
    }
  }
  for (const auto& [path, tables] : record_->tables) {
    const Found found = find(path);
    if (found.node != tables.source) continue;  // a layer added since has replaced the array
    for (std::size_t i = 0; i < tables.elements.size(); ++i) {
      element(found, path, i, tables.elements[i]).reject_unknown();
    }
  }
}

std::string ConfigTree::effective() const {
  std::string text;
  for (const auto& [path, value] : record_->entries()) text += path + " = " + value + "\n";
  return text;
}

std::map<std::string, std::string> settings_in(std::string_view effective) {
  std::map<std::string, std::string> settings;
  while (!effective.empty()) {
    const std::string_view line = effective.substr(0, effective.find('\n'));
    effective.remove_prefix(std::min(line.size() + 1, effective.size()));
    const std::size_t at = line.find(" = ");
    if (at != std::string_view::npos) settings.emplace(line.substr(0, at), line.substr(at + 3));
  }
  return settings;
}

}  // namespace sandrunner
