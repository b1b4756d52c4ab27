#include "data/trace/derived_hash.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate::data {

using engine::TickRecord;
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::size_t kBytes = sizeof(TickRecord);
static_assert(kBytes == 208);
constexpr std::size_t kHashedTicks = 32;  ///< at once: 7 kB of the first cache

/// The fields one after the other, which are all of a tick.
template <class... Fields>
void join(std::byte* out, const Fields&... fields) noexcept {
    static_assert((sizeof(Fields) + ...) == kBytes);
    ((std::memcpy(out, &fields, sizeof fields), out += sizeof fields), ...);
}

void declared(const TickRecord& t, std::byte* out) noexcept {
    using engine::Vec2;
    join(out, t.tick, t.time_ns, Vec2(t.hip), Vec2(t.cp), Vec2(t.go), Vec2(t.force),
         Vec2(t.command), t.normal_force, t.tangential_force, t.mu, t.u, t.counts[0], t.counts[1],
         t.codes[0], t.codes[1], t.lateness_us, t.segment, t.mode, t.flags, t.hip.z, t.cp.z, t.go.z,
         t.force.z, t.command.z, t.v, t.counts[2], t.codes[2]);
}

}  // namespace

std::uint64_t derived_hash(std::span<const TickRecord> ticks) noexcept {
    DerivedHash hash;
    hash.add(ticks);
    return hash.value();
}

DerivedHash::DerivedHash() noexcept {
    static_assert(sizeof(XXH3_state_t) <= sizeof state_ && alignof(XXH3_state_t) <= 64);
    XXH3_64bits_reset(new (state_.data()) XXH3_state_t);
}

void DerivedHash::add(std::span<const TickRecord> ticks) noexcept {
    auto* const state = std::launder(reinterpret_cast<XXH3_state_t*>(state_.data()));
    std::array<std::byte, kHashedTicks * kBytes> some;
    while (!ticks.empty()) {
        const auto part = ticks.first(std::min(ticks.size(), kHashedTicks));
        for (std::size_t i = 0; i < part.size(); ++i) {
            declared(part[i], &some[i * kBytes]);
        }
        XXH3_64bits_update(state, some.data(), part.size() * kBytes);
        ticks = ticks.subspan(part.size());
    }
}

std::uint64_t DerivedHash::value() const noexcept {
    return XXH3_64bits_digest(std::launder(reinterpret_cast<const XXH3_state_t*>(state_.data())));
}

}  // namespace palpate::data
