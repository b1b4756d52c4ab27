#pragma once

#include <cstdint>
#include <string>

#include "engine/base/pcg32.hpp"
#include "engine/device/hand_path.hpp"
#include "engine/device/simulated_gantry.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/protocol/observer_model.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// How a simulated participant explores. Every trial's way is drawn from the stream "hand" of its
/// position, that of a second interval from "hand.second", so that a resumed session explores as
/// the unbroken one.
class DrawnHand {
public:
    /// @param own  how fast and how deep this person goes, as factors
    DrawnHand(const Protocol& protocol,
              std::string protocol_hash,
              SessionKey key,
              std::uint64_t seed,
              const HandSpec& own = {});

    /// The way of a trial over plane objects. @param interval  1 or 2
    [[nodiscard]] engine::Exploration at(std::size_t position, std::size_t interval = 1) const;
    /// The same of a study of surfaces. @pre the protocol has them
    [[nodiscard]] engine::SurfaceExploration on_surface(std::size_t position,
                                                        std::size_t interval = 1) const;

private:
    [[nodiscard]] Pcg32 stream_of(std::size_t position, std::size_t interval) const;

    OutlineSpec outline_;
    SurfaceSpec surface_;
    engine::Vec2 start_;
    std::string protocol_hash_;
    SessionKey key_;
    std::uint64_t seed_;
    HandSpec own_;
};

}  // namespace palpate::protocols
