#include "data/trace/derived_hash.hpp"

#include <bit>
#include <cstddef>
#include <new>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate::data {

using engine::TickRecord;

// The declared order is that of the struct in memory. Who changes the struct copies it to this one.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(TickRecord) == 208);
static_assert(offsetof(TickRecord, tick) == 0 && offsetof(TickRecord, time_ns) == 8);
static_assert(offsetof(TickRecord, hip) == 16 && offsetof(TickRecord, cp) == 32);
static_assert(offsetof(TickRecord, go) == 48 && offsetof(TickRecord, force) == 64);
static_assert(offsetof(TickRecord, command) == 80 && offsetof(TickRecord, normal_force) == 96);
static_assert(offsetof(TickRecord, tangential_force) == 104 && offsetof(TickRecord, mu) == 112);
static_assert(offsetof(TickRecord, u) == 120 && offsetof(TickRecord, counts) == 128);
static_assert(offsetof(TickRecord, codes) == 136 && offsetof(TickRecord, lateness_us) == 144);
static_assert(offsetof(TickRecord, segment) == 148 && offsetof(TickRecord, mode) == 150);
static_assert(offsetof(TickRecord, flags) == 151);
static_assert(offsetof(TickRecord, hip_z) == 152 && offsetof(TickRecord, cp_z) == 160);
static_assert(offsetof(TickRecord, go_z) == 168 && offsetof(TickRecord, force_z) == 176);
static_assert(offsetof(TickRecord, command_z) == 184 && offsetof(TickRecord, v) == 192);
static_assert(offsetof(TickRecord, count_3) == 200 && offsetof(TickRecord, code_3) == 204);

std::uint64_t derived_hash(std::span<const TickRecord> ticks) noexcept {
    return XXH3_64bits(ticks.data(), ticks.size_bytes());
}

DerivedHash::DerivedHash() noexcept {
    static_assert(sizeof(XXH3_state_t) <= sizeof state_ && alignof(XXH3_state_t) <= 64);
    XXH3_64bits_reset(new (state_.data()) XXH3_state_t);
}

void DerivedHash::add(std::span<const TickRecord> ticks) noexcept {
    XXH3_64bits_update(std::launder(reinterpret_cast<XXH3_state_t*>(state_.data())), ticks.data(),
                       ticks.size_bytes());
}

std::uint64_t DerivedHash::value() const noexcept {
    return XXH3_64bits_digest(std::launder(reinterpret_cast<const XXH3_state_t*>(state_.data())));
}

}  // namespace palpate::data
