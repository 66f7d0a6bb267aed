// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sandrunner::sim {

/// More than any description of a robot with four legs has: bytes, elements in each other,
/// elements, attributes of an element.
inline constexpr std::size_t kMaxUrdfBytes = std::size_t{1} << 20;
inline constexpr int kMaxUrdfDepth = 32;
inline constexpr std::size_t kMaxUrdfElements = 4'000;
inline constexpr std::size_t kMaxUrdfAttributes = 64;

/// The text of a URDF as urdfdom takes it: without <dynamics/>, on whose attributes urdfdom insists
/// and which means nothing to us, and without blanks around attribute values, which exporters
/// write. Throws InputError "NAME: ..." for more than the limits above: urdfdom recurses over
/// elements, and its time is the square of the attributes of one. Whether the text is good XML is
/// left to urdfdom.
std::string tolerable_urdf(std::string_view text, const std::string& name);

}  // namespace sandrunner::sim
