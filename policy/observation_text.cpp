// SPDX-License-Identifier: BSD-3-Clause
// The terms of an observation as policy files have them.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include "policy/names.h"
#include "policy/observation_layout.h"

namespace sandrunner {
namespace {

constexpr Named<TermKind> kTerms[] = {{TermKind::kAngularVelocity, "angular_velocity"},
                                      {TermKind::kGravity, "gravity"},
                                      {TermKind::kCommand, "command"},
                                      {TermKind::kJointPosition, "joint_position"},
                                      {TermKind::kJointVelocity, "joint_velocity"},
                                      {TermKind::kLastAction, "last_action"},
                                      {TermKind::kPhase, "phase"}};
/// What networks of others see, and no robot measures.
constexpr const char* kNotMeasured[] = {"linear_velocity", "height_scan", "foot_contact"};

constexpr Named<HistoryOrder> kOrders[] = {{HistoryOrder::kNewestFirst, "newest_first"},
                                           {HistoryOrder::kOldestFirst, "oldest_first"},
                                           {HistoryOrder::kByTerm, "by_term"}};

std::optional<double> number_of(const std::string& word) {
  double value = 0.0;
  const char* const end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  const double size = std::fabs(value);
  const bool good = value == 0.0 || (size >= 1e-6 && size <= 1e6);  // NaN: neither
  if (result.ec != std::errc() || result.ptr != end || !good) return std::nullopt;
  return value;
}

[[noreturn]] void fail_term(const std::string& where, const std::string& text,
                            const std::string& expected) {
  throw InputError(fmt::format("{}: found '{}', expected {}", where, printable(text), expected));
}

/// One term: "NAME [scale S ...] [clip L] [period P]".
ObservationTerm parse_term(const std::string& where, const std::string& text) {
  std::istringstream stream(text);
  const std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
  const std::string name = words.empty() ? "" : words.front();
  if (std::ranges::find(kNotMeasured, std::string_view(name)) != std::end(kNotMeasured)) {
    fail_term(where, text, "what a robot measures; train without it, or estimate it");
  }
  const auto row = std::ranges::find_if(kTerms, [&](const auto& r) { return name == r.name; });
  if (row == std::end(kTerms)) fail_term(where, text, "one of " + names_of(kTerms));
  ObservationTerm term;
  term.kind = row->value;
  std::vector<double>* values = nullptr;
  std::vector<double> clip, period;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "scale" || word == "clip" || word == "period") {
      values = word == "scale" ? &term.scale : word == "clip" ? &clip : &period;
      continue;
    }
    const std::optional<double> value = number_of(word);
    if (!values || !value)
      fail_term(where, text, "'NAME scale NUMBER ... clip NUMBER', numbers of 1e-6 to 1e6");
    values->push_back(*value);
  }
  const auto scales = static_cast<int>(term.scale.size());
  const int size = term_size(term.kind);
  if (scales > 1 && scales != size) {
    fail_term(where, text, fmt::format("one scale or {}", size));
  }
  const auto one_positive = [&](const std::vector<double>& found, const char* what) {
    if (found.size() != 1 || found[0] <= 0.0) {
      fail_term(where, text, fmt::format("a {} above 0", what));
    }
    return found[0];
  };
  if (!clip.empty()) term.clip = one_positive(clip, "clip");
  if (term.kind != TermKind::kPhase && !period.empty()) {
    fail_term(where, text, "a period of the phase alone");
  }
  if (term.kind == TermKind::kPhase) term.period_s = one_positive(period, "period (s)");
  return term;
}

}  // namespace

std::vector<ObservationTerm> parse_terms(const std::string& where, const std::string& text) {
  std::vector<ObservationTerm> terms;
  std::istringstream stream(text);
  int numbers = 0;
  for (std::string part; std::getline(stream, part, ',');) {
    terms.push_back(parse_term(where, part));
    numbers += term_size(terms.back().kind);
  }
  if (numbers == 0 || numbers > ObservationLayout::kMostNumbers) {
    throw InputError(fmt::format("{}: found {} numbers, expected 1 to {}", where, numbers,
                                 ObservationLayout::kMostNumbers));
  }
  return terms;
}

std::string terms_text(const std::vector<ObservationTerm>& terms) {
  std::vector<std::string> texts;
  for (const ObservationTerm& term : terms) {
    std::string text = name_of(kTerms, term.kind);
    if (!term.scale.empty()) text += " scale " + joined(term.scale, " ");
    if (term.clip > 0.0) text += fmt::format(" clip {}", term.clip);
    if (term.period_s > 0.0) text += fmt::format(" period {}", term.period_s);
    texts.push_back(text);
  }
  return joined(texts, ", ");
}

HistoryOrder parse_history_order(const std::string& where, const std::string& text) {
  return value_named(kOrders, where, text);
}

std::string history_order_text(HistoryOrder order) { return name_of(kOrders, order); }

}  // namespace sandrunner
