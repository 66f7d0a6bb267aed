// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/tick_fields.h"

#include <fmt/format.h>

namespace sandrunner {

std::string tick_word_name(std::size_t word) {
  for (const TickField& field : kTickFields) {
    const auto words = static_cast<std::size_t>(field.words);
    if (word < words) return words == 1 ? field.name : fmt::format("{}[{}]", field.name, word);
    word -= words;
  }
  return "?";
}

std::string tick_idl() {
  std::string idl = "module sandrunner {\n  struct Tick {\n";
  for (const TickField& field : kTickFields) {
    const char* const type = field.kind == 'd'   ? "double"
                             : field.kind == 'u' ? "unsigned long long"
                                                 : "long long";
    idl += field.words == 1 ? fmt::format("    {} {};\n", type, field.name)
                            : fmt::format("    {} {}[{}];\n", type, field.name, field.words);
  }
  return idl +
         "  };\n  struct TickBatch {\n    unsigned long long sequence_number;\n"
         "    sequence<Tick> ticks;\n  };\n};\n";
}

}  // namespace sandrunner
