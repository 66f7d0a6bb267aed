// SPDX-License-Identifier: BSD-3-Clause
#include "policy/wiring.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "policy/names.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr Named<EncoderKind> kEncoders[] = {
    {EncoderKind::kLstm, "lstm"}, {EncoderKind::kTcn, "tcn"}, {EncoderKind::kInsight, "insight"}};

struct PartName {
  const char* name;
  bool ActorInputs::* seen;
};
constexpr PartName kParts[] = {{"encoding", &ActorInputs::encoding},
                               {"estimate", &ActorInputs::estimate},
                               {"proprioception", &ActorInputs::proprioception},
                               {"terrain", &ActorInputs::terrain}};

}  // namespace

EncoderKind parse_encoder(const std::string& key, const std::string& text) {
  return value_named(kEncoders, key, text);
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

std::string encoder_text(EncoderKind encoder) { return name_of(kEncoders, encoder); }

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
