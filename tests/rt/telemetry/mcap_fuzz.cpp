// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer on the reader: any bytes lead to messages and an end, or to an InputError. How to run
// it: rt/telemetry/README.md.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "mcap_bytes.h"
#include "rt/base/errors.h"
#include "rt/telemetry/mcap/mcap_reader.h"

namespace sandrunner {
namespace {

void read_all(const std::string& bytes) {
  std::istringstream stream(bytes);
  try {
    McapReader reader(stream, "fuzz");
    // Touches every byte that is handed out, so that the sanitizer sees each span.
    static volatile unsigned sum;
    while (const McapMessage* message = reader.next()) {
      for (const std::byte byte : message->data) sum = sum + static_cast<unsigned>(byte);
    }
  } catch (const InputError&) {
  }
}

/// The bytes as a file, after a header, and inside chunks without a CRC that would stop the fuzzer.
void read_everywhere(const std::string& bytes) {
  read_all(bytes);
  read_all(kMagic + header("fuzz") + bytes);
  read_all(file_with_chunk(schema(1, "a/msg/B") + channel(1, 1, "/b") + bytes));
  read_all(kMagic + header("fuzz") + chunk(bytes.size() * 4, 0, "zstd", bytes));
}

}  // namespace
}  // namespace sandrunner

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sandrunner::read_everywhere({reinterpret_cast<const char*>(data), size});
  return 0;
}
