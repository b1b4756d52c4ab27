#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/geometry/outline.hpp"
#include "stimuli/surface_patch.hpp"
#include "stimuli/two_curve.hpp"
#include "protocols/protocol/protocol.hpp"

/// The geometry of a protocol's objects: one outline for what is felt, what is shown and what is
/// hashed.
namespace palpate::protocols {

/// The object as two curves on the protocol's [outline], placed. @pre it is one: without segments
[[nodiscard]] stimuli::TwoCurve object_of(const Protocol& protocol, const ObjectSpec& spec);

/// @throws std::invalid_argument if it cannot be built; no object read from a file is like that
[[nodiscard]] std::shared_ptr<const engine::Outline> outline_of(const Protocol& protocol,
                                                                std::size_t object);
[[nodiscard]] std::shared_ptr<const engine::Outline> outline_of(const Protocol& protocol,
                                                                const ObjectSpec& spec);

/// The object as a patch of a surface, with its rim. @pre the protocol has surfaces
/// @throws std::invalid_argument if it cannot be built; no object read from a file is like that
[[nodiscard]] std::shared_ptr<const engine::NurbsSurface> surface_of(const Protocol& protocol,
                                                                     const ObjectSpec& spec);

/// Its picture: a closed polyline, m. Of a surface the border of its patch, as it is drawn.
[[nodiscard]] std::vector<engine::Vec2> silhouette_of(const Protocol& protocol, std::size_t object);

/// Where it is felt, seen from above: its picture, or of a surface the border of its patch, m.
[[nodiscard]] std::vector<engine::Vec2> plan_of(const Protocol& protocol, std::size_t object);

/// Signed curvature of both curves as they are felt, 1/m: of the file, by the size; of a patch the
/// one along x. A free form has none.
[[nodiscard]] std::optional<double> curvature_of(const ObjectSpec& object) noexcept;

/// All objects are two curves between the chords of [outline], as they stand there: what is felt
/// differs in curvature alone.
[[nodiscard]] bool differ_in_curvature_alone(const Protocol& protocol) noexcept;

}  // namespace palpate::protocols
