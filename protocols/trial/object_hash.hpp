#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/geometry/outline.hpp"
#include "engine/surface/nurbs_surface.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// The exact geometry of an outline as text, a line for each of its spans and control points:
///
///     palpate-outline-v1 closed
///     span 0 degree 2 parameters BITS BITS ratio BITS
///     point BITS BITS weight BITS
///
/// BITS are the 16 hexadecimal digits of an IEEE 754 double, in m for points; parameters are those
/// of the experimenter's segment (its knots) where the span begins and ends.
[[nodiscard]] std::string outline_text(const engine::Outline& outline);

/// The same of a surface, by its rational Bezier patches, coordinates about the surface's origin:
///
///     palpate-surface-v1 origin BITS BITS BITS
///     patch 0 0 degree 2 2
///     point BITS BITS BITS weight BITS
///
/// Points are homogeneous: coordinates times the weight, m.
[[nodiscard]] std::string surface_text(const engine::NurbsSurface& surface);

/// "object sha256 NAME" with the SHA-256 (hex) of outline_text() or surface_text() for every object
/// of a protocol, in its order: two sessions with the same hash felt the same geometry, to the bit.
/// @throws std::invalid_argument if an outline cannot be built
[[nodiscard]] std::vector<std::pair<std::string, std::string>> object_hashes(
    const Protocol& protocol);

}  // namespace palpate::protocols
