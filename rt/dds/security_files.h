// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner {

/// Throws InputError unless both are PEM files and the key is the certificate's. Cyclone DDS checks
/// all else of the security files when a participant is created, but not this: it would start, and
/// nobody would ever hear it.
void check_key(const std::string& certificate_path, const std::string& key_path);

}  // namespace sandrunner
