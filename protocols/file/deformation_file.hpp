#pragma once

#include <string_view>
#include <vector>

#include "engine/deformation/dnurbs.hpp"
#include "protocols/file/schema.hpp"

/// Cases of `palpate deform`: TOML text -> a deformable curve and the force on it. Problems are
/// reported like those of a protocol.
namespace palpate::protocols {

/// A curve, and what pulls at it.
struct DeformationCase {
    engine::Dnurbs curve;
    engine::Vec2 force{};  ///< N, on the curve, from time 0 on
    double at_u = 0.0;     ///< in the domain of the curve
    double step = 0.001;   ///< s
    bool at_rest = false;  ///< only where it comes to rest
};

/// @throws ProtocolError with one line a problem: file:line:column, what, the value, what to do
[[nodiscard]] DeformationCase parse_deformation(std::string_view text, std::string_view file_name);

/// What a case may say.
[[nodiscard]] std::vector<TableText> deformation_reference();

}  // namespace palpate::protocols
