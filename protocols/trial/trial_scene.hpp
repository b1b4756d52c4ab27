#pragma once

#include <span>
#include <vector>

#include "engine/realtime/felt_scene.hpp"
#include "engine/rendering/scene.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/trial/observer.hpp"
#include "protocols/trial/presentation.hpp"

/// From a condition to what is felt and what is shown.
namespace palpate::protocols {

/// The compiled scene of an interval, in the plane or in space. @throws std::invalid_argument if it
/// cannot be built
[[nodiscard]] engine::FeltScene make_felt_scene(const Protocol& protocol, const Presentation& felt);
/// The pictures in the order of the screen. @param order  place -> index into Protocol::objects
[[nodiscard]] std::vector<Picture> make_pictures(const Protocol& protocol,
                                                 std::span<const std::size_t> order);

/// What is asked after every trial. @param pictures  outlive it
[[nodiscard]] Question question_of(const Protocol& protocol, std::span<const Picture> pictures);

}  // namespace palpate::protocols
