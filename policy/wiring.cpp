// SPDX-License-Identifier: BSD-3-Clause
#include "policy/wiring.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

struct EncoderName {
  const char* name;
  EncoderKind kind;
};
constexpr EncoderName kEncoders[] = {
    {"lstm", EncoderKind::kLstm}, {"tcn", EncoderKind::kTcn}, {"insight", EncoderKind::kInsight}};

struct PartName {
  const char* name;
  bool ActorInputs::*seen;
};
constexpr PartName kParts[] = {{"encoding", &ActorInputs::encoding},
                               {"estimate", &ActorInputs::estimate},
                               {"proprioception", &ActorInputs::proprioception},
                               {"terrain", &ActorInputs::terrain}};

template <typename Table>
std::string names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

EncoderKind parse_encoder(const std::string& key, const std::string& text) {
  for (const EncoderName& encoder : kEncoders) {
    if (text == encoder.name) return encoder.kind;
  }
  throw InputError(
      fmt::format("{}: found '{}', expected one of {}", key, text, names_of(kEncoders)));
}

ActorInputs parse_actor_inputs(const std::string& key, const std::string& text) {
  ActorInputs sees{false, false, false, false};
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    const auto part =
        std::ranges::find_if(kParts, [&](const PartName& p) { return name == p.name; });
    if (part == std::end(kParts)) {
      throw InputError(fmt::format("{}: found '{}', expected some of {} with ', ' between them",
                                   key, name, names_of(kParts)));
    }
    sees.*part->seen = true;
    begin = end + 1;
    while (begin < text.size() && text[begin] == ' ') ++begin;
  }
  return sees;
}

std::string encoder_text(EncoderKind encoder) {
  return std::ranges::find_if(kEncoders, [&](const EncoderName& e) { return e.kind == encoder; })
      ->name;
}

std::string actor_inputs_text(const ActorInputs& actor) {
  std::vector<std::string> seen;
  for (const PartName& part : kParts) {
    if (actor.*part.seen) seen.emplace_back(part.name);
  }
  return fmt::format("{}", fmt::join(seen, ", "));
}

std::string wiring_text(const Wiring& wiring) {
  return fmt::format("encoder {}, actor sees {}", encoder_text(wiring.encoder),
                     actor_inputs_text(wiring.actor_sees));
}

}  // namespace sandrunner
