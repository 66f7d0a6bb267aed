// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_script.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "rt/base/errors.h"

namespace sandrunner::hil {
namespace {

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text), words_(text) {}

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InputError(fmt::format("--fault '{}': found {}, expected {}", text_, found, expected));
  }

  std::string word(const char* expected) {
    std::string word;
    if (!(words_ >> word)) fail("no more", expected);
    return word;
  }
  double number(const std::string& text, const char* what) const {
    std::istringstream in(text);
    double value = 0.0;
    if (!(in >> value) || !in.eof()) fail("'" + text + "'", what);
    return value;
  }
  double number() { return number(word("a number"), "a number"); }
  /// The index of the next word among `names`.
  int one_of(std::span<const std::string> names, const char* what) {
    const std::string name = word(what);
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      fail("'" + name + "'", fmt::format("one of {}", fmt::join(names, ", ")));
    }
    return static_cast<int>(found - names.begin());
  }
  void end() {
    std::string more;
    if (words_ >> more) fail("'" + more + "'", "no more");
  }

 private:
  const std::string& text_;
  std::istringstream words_;
};

}  // namespace

TimedFault read_fault(const std::string& text, const FaultWords& words) {
  Reader reader(text);
  TimedFault fault;
  fault.text = text;
  const char* const times = "a time in s, start, or start+S";
  const std::string time = reader.word(times), after = "start+";
  fault.from_start = time == "start" || time.starts_with(after);
  if (time != "start") {
    fault.at_s = reader.number(fault.from_start ? time.substr(after.size()) : time, times);
  }
  if (!(fault.at_s >= 0.0)) reader.fail("a negative time", times);
  std::vector<std::string> names;
  for (const FaultKind& kind : words.kinds) names.emplace_back(kind.name);
  const FaultKind& kind = words.kinds[reader.one_of(names, "a kind of fault")];
  fault.kind = kind.name;
  const auto joint = [&] { return reader.one_of(words.joints, "a joint"); };
  switch (kind.takes) {
    case Takes::kNothing:
      break;
    case Takes::kNumber:
      fault.value = reader.number();
      break;
    case Takes::kJoint:
      fault.first = joint();
      break;
    case Takes::kJointAndNumber:
      fault.first = joint();
      fault.value = reader.number();
      break;
    case Takes::kTwoJoints:
      fault.first = joint();
      fault.second = joint();
      break;
    case Takes::kBus:
      fault.first = reader.one_of(words.buses, "an interface");
      break;
  }
  reader.end();
  return fault;
}

}  // namespace sandrunner::hil
