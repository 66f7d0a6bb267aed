// SPDX-License-Identifier: BSD-3-Clause
// mcap_sample FILE MESSAGES: writes the recording of mcap_sample.h, for readers that are not ours
// and as a seed of the fuzzer.
#include "mcap_sample.h"

#include <cstdio>
#include <cstdlib>

#include "rt/base/errors.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: mcap_sample FILE MESSAGES\n", stderr);
    return sandrunner::kExitBadInput;
  }
  try {
    sandrunner::McapWriter writer(argv[1]);
    sandrunner::write_sample(writer, std::atoi(argv[2]), 0);
    writer.close();
  } catch (const sandrunner::InputError& error) {
    std::fprintf(stderr, "mcap_sample: %s\n", error.what());
    return sandrunner::kExitBadInput;
  }
  return sandrunner::kExitOk;
}
