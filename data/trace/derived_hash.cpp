#include "data/trace/derived_hash.hpp"

#include <algorithm>
#include <array>
#include <bit>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate::data {
namespace {

static_assert(std::endian::native == std::endian::little, "the hash is declared little endian");

struct Derived {
    engine::Vec2 hip, cp, go, force, command;
    double normal_force, tangential_force, mu, parameter;
    std::int16_t feature;
    std::uint8_t mode, flags;
    std::uint32_t zero;
};
static_assert(sizeof(Derived) == 120);

Derived derived_of(const engine::TickRecord& tick) noexcept {
    return {.hip = tick.hip,
            .cp = tick.cp,
            .go = tick.go,
            .force = tick.force,
            .command = tick.command,
            .normal_force = tick.normal_force,
            .tangential_force = tick.tangential_force,
            .mu = tick.mu,
            .parameter = tick.parameter,
            .feature = tick.feature,
            .mode = static_cast<std::uint8_t>(tick.mode),
            .flags = static_cast<std::uint8_t>(tick.flags & kSceneFlags),
            .zero = 0};
}

}  // namespace

std::uint64_t derived_hash(std::span<const engine::TickRecord> ticks) noexcept {
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    std::array<Derived, 64> some;
    while (!ticks.empty()) {
        const std::size_t n = std::min(ticks.size(), some.size());
        std::transform(ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(n), some.begin(),
                       derived_of);
        XXH3_64bits_update(&state, some.data(), n * sizeof(Derived));
        ticks = ticks.subspan(n);
    }
    return XXH3_64bits_digest(&state);
}

}  // namespace palpate::data
