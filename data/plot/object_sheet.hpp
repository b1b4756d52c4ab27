#pragma once

#include <string>
#include <string_view>

#include "protocols/protocol/protocol.hpp"

namespace palpate::data {

/// Height of a circular arc of signed `curvature` (1/m) above its `chord` (m): > 0 outwards, m.
/// c^2 k / (4 (1 + sqrt(1 - (k c / 2)^2))), which keeps its digits near k = 0. @pre |k| c <= 2
[[nodiscard]] double sagitta(double curvature, double chord) noexcept;

/// All objects of a protocol on one sheet at one scale: outline, chords, name, curvature, sagitta
/// in mm, whether it is pictured; a bar of whole mm below. A standalone SVG 1.1 text; the same
/// protocol gives the same bytes. @param hash protocol_hash(protocol)
/// @throws std::invalid_argument if an object cannot be built (none of a protocol read from a file)
[[nodiscard]] std::string object_sheet(const protocols::Protocol& protocol, std::string_view hash);

}  // namespace palpate::data
