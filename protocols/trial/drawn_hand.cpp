#include "protocols/trial/drawn_hand.hpp"

#include <utility>

#include "engine/math/elementary.hpp"
#include "protocols/design/session_plan.hpp"

namespace palpate::protocols {
namespace {

/// Uniform in [0, 1) with 32 bits: exact in double.
double unit(Pcg32& random) {
    return static_cast<double>(random.next()) * 0x1p-32;
}

}  // namespace

DrawnHand::DrawnHand(const Protocol& protocol,
                     std::string protocol_hash,
                     SessionKey key,
                     std::uint64_t seed,
                     const HandSpec& own)
    : outline_(protocol.outline),
      surface_(protocol.surface.value_or(SurfaceSpec{})),
      start_(protocol.apparatus.start),
      protocol_hash_(std::move(protocol_hash)),
      key_(std::move(key)),
      seed_(seed),
      own_(own) {}

Pcg32 DrawnHand::stream_of(std::size_t position, std::size_t interval) const {
    StreamKey own = session_stream(protocol_hash_, key_, seed_);
    own.block = position;
    own.purpose = interval == 1 ? purpose::hand : purpose::second_hand;
    return stream(own);
}

engine::SurfaceExploration DrawnHand::on_surface(std::size_t position, std::size_t interval) const {
    Pcg32 random = stream_of(position, interval);
    engine::SurfaceExploration plan{
        .start = engine::Vec3(start_, surface_.start_height),
        .radius = (0.36 + 0.08 * unit(random)) * surface_.size,  // within the patch all around
    };
    plan.speed = own_.speed * (0.065 + 0.030 * unit(random));
    plan.press_depth = own_.press * (0.0085 + 0.0015 * unit(random));
    plan.strokes = 6 + static_cast<int>(random.bounded(3));
    plan.turn = 2.0 * engine::kPi * unit(random);
    plan.tremor_phase = 2.0 * engine::kPi * unit(random);
    return plan;
}

engine::Exploration DrawnHand::at(std::size_t position, std::size_t interval) const {
    Pcg32 random = stream_of(position, interval);
    engine::Exploration plan{
        .start = start_, .a = outline_.a, .vertex = outline_.vertex, .b = outline_.b};
    plan.speed = own_.speed * (0.065 + 0.030 * unit(random));  // 65 to 95 mm/s
    // 8.5 to 10 mm: reaches into every object.
    plan.press_depth = own_.press * (0.0085 + 0.0015 * unit(random));
    plan.sweeps = 3 + static_cast<int>(random.bounded(3));
    plan.tremor_phase = 2.0 * engine::kPi * unit(random);
    return plan;
}

}  // namespace palpate::protocols
