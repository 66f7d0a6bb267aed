// SPDX-License-Identifier: BSD-3-Clause
#include "policy/observation_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include "policy/activations.h"
#include "policy/names.h"

namespace sandrunner {
namespace {

struct TermRow {
  TermKind kind;
  const char* name;
  int size;
};
constexpr TermRow kTerms[] = {{TermKind::kAngularVelocity, "angular_velocity", 3},
                              {TermKind::kGravity, "gravity", 3},
                              {TermKind::kCommand, "command", 3},
                              {TermKind::kJointPosition, "joint_position", kNumJoints},
                              {TermKind::kJointVelocity, "joint_velocity", kNumJoints},
                              {TermKind::kLastAction, "last_action", kNumJoints},
                              {TermKind::kPhase, "phase", 2}};
/// What networks of others see, and no robot measures.
constexpr const char* kNotMeasured[] = {"linear_velocity", "height_scan", "foot_contact"};

constexpr Named<HistoryOrder> kOrders[] = {{HistoryOrder::kNewestFirst, "newest_first"},
                                           {HistoryOrder::kOldestFirst, "oldest_first"},
                                           {HistoryOrder::kByTerm, "by_term"}};

const TermRow& row_of(TermKind kind) {
  return *std::ranges::find_if(kTerms, [&](const TermRow& row) { return row.kind == kind; });
}

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
  const auto row = std::ranges::find_if(kTerms, [&](const TermRow& r) { return name == r.name; });
  if (row == std::end(kTerms)) fail_term(where, text, "one of " + names_of(kTerms));
  ObservationTerm term;
  term.kind = row->kind;
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
  if (scales > 1 && scales != row->size) {
    fail_term(where, text, fmt::format("one scale or {}", row->size));
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

/// Sine of 2 pi x, of a turn: an odd polynomial on a quarter, folded; error below 1e-7.
double sine_of_turn(double x) noexcept {
  double t = x - std::floor(x + 0.5);  // -0.5 to 0.5
  if (t > 0.25) t = 0.5 - t;
  if (t < -0.25) t = -0.5 - t;
  const double a = 6.283185307179586 * t, s = a * a;
  double p = 1.0 / 6227020800.0;
  p = std::fma(p, s, -1.0 / 39916800.0);
  p = std::fma(p, s, 1.0 / 362880.0);
  p = std::fma(p, s, -1.0 / 5040.0);
  p = std::fma(p, s, 1.0 / 120.0);
  p = std::fma(p, s, -1.0 / 6.0);
  return std::fma(p * s, a, a);
}

float number_of_term(const ObservationTerm& term, const TermInputs& in, int i) noexcept {
  const auto at = static_cast<std::size_t>(i);
  switch (term.kind) {
    case TermKind::kAngularVelocity:
      return in.observation[6 + at];
    case TermKind::kGravity:
      return -in.observation[3 + at];
    case TermKind::kCommand:
      return in.observation[at];
    case TermKind::kJointPosition:
      return in.position_rad[at];
    case TermKind::kJointVelocity:
      return in.velocity_radps[at];
    case TermKind::kLastAction:
      return in.last_action[at];
    case TermKind::kPhase:
      break;
  }
  return static_cast<float>(sine_of_turn(in.time_s / term.period_s + (i == 0 ? 0.0 : 0.25)));
}

}  // namespace

int ObservationLayout::numbers() const {
  int sum = 0;
  for (const ObservationTerm& term : terms) sum += term_size(term.kind);
  return sum;
}

int term_size(TermKind kind) { return row_of(kind).size; }

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
    std::string text = row_of(term.kind).name;
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

void write_observation(const ObservationLayout& layout, const TermInputs& in,
                       float* numbers) noexcept {
  for (const ObservationTerm& term : layout.terms) {
    const int size = term_size(term.kind);
    for (int i = 0; i < size; ++i, ++numbers) {
      const float value = number_of_term(term, in, i);
      const float limited = term.clip > 0.0 ? clip(value, static_cast<float>(term.clip)) : value;
      const std::size_t at = term.scale.size() == 1 ? 0 : static_cast<std::size_t>(i);
      const float scaled =
          term.scale.empty() ? limited : limited * static_cast<float>(term.scale[at]);
      *numbers = layout.clip > 0.0 ? clip(scaled, static_cast<float>(layout.clip)) : scaled;
    }
  }
}

void arrange(const ObservationLayout& layout, const float* newest_first, float* input) noexcept {
  const int numbers = layout.numbers();
  if (layout.order == HistoryOrder::kNewestFirst) {
    std::copy_n(newest_first, layout.inputs(), input);
    return;
  }
  // Blocks of a whole observation or of one term, each from the oldest step to the newest.
  int begin = 0;
  const auto add_block = [&](int size) {
    for (int step = layout.history - 1; step >= 0; --step, input += size) {
      std::copy_n(newest_first + step * numbers + begin, size, input);
    }
    begin += size;
  };
  if (layout.order == HistoryOrder::kOldestFirst) return add_block(numbers);
  for (const ObservationTerm& term : layout.terms) add_block(term_size(term.kind));
}

}  // namespace sandrunner
