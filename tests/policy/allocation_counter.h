// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace sandrunner {

/// Calls of operator new in this program so far.
std::size_t number_of_allocations();

}  // namespace sandrunner
