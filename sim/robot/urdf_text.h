// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sandrunner::sim {

/// More than any robot's description has: elements in each other, and elements.
inline constexpr int kMaxUrdfDepth = 32;
inline constexpr std::size_t kMaxUrdfElements = 10'000;

/// The text of a URDF as urdfdom takes it: without <dynamics/>, on whose attributes urdfdom insists
/// and which means nothing to us, and without blanks around attribute values, which exporters
/// write. Throws InputError "NAME: ..." for more elements than the limits above: urdfdom recurses
/// over them. Whether the text is good XML is left to urdfdom.
std::string tolerable_urdf(std::string_view text, const std::string& name);

}  // namespace sandrunner::sim
