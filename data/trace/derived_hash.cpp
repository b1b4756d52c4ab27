#include "data/trace/derived_hash.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#if defined(__x86_64__)  // for the processors that have AVX2 as well: see update()
#include <immintrin.h>
#define XXH_DISPATCH_AVX2 1
#define XXH_TARGET_AVX2 __attribute__((__target__("avx2")))
#endif
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "engine/base/processor.hpp"

namespace palpate::data {

using engine::TickRecord;
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::size_t kBytes = sizeof(TickRecord);
static_assert(kBytes == 208);
constexpr std::size_t kHashedTicks = 32;  ///< at once: 7 kB of the first cache

/// Bytes of a tick from one of its fields on: neighbours that are hashed as they lie.
template <std::size_t Size>
struct Bytes {
    std::array<std::byte, Size> bytes;
};
template <std::size_t Size>
Bytes<Size> from(const TickRecord& tick, std::size_t offset) noexcept {
    Bytes<Size> some;
    std::memcpy(&some, reinterpret_cast<const std::byte*>(&tick) + offset, Size);
    return some;
}

/// The fields one after the other, which are all of a tick.
template <class... Fields>
void join(std::byte* out, const Fields&... fields) noexcept {
    static_assert((sizeof(Fields) + ...) == kBytes);
    ((std::memcpy(out, &fields, sizeof fields), out += sizeof fields), ...);
}

/// Vectors lie with their z, and x and y are hashed first.
void declared(const TickRecord& t, std::byte* out) noexcept {
    constexpr auto kTwo = 2 * sizeof(std::int32_t);
    join(out, from<16>(t, offsetof(TickRecord, tick)), from<16>(t, offsetof(TickRecord, hip)),
         from<16>(t, offsetof(TickRecord, cp)), from<16>(t, offsetof(TickRecord, go)),
         from<16>(t, offsetof(TickRecord, force)), from<16>(t, offsetof(TickRecord, command)),
         from<32>(t, offsetof(TickRecord, normal_force)),
         from<kTwo>(t, offsetof(TickRecord, counts)), from<kTwo>(t, offsetof(TickRecord, codes)),
         from<8>(t, offsetof(TickRecord, lateness_us)), t.hip.z, t.cp.z, t.go.z, t.force.z,
         t.command.z, t.v, t.counts[2], t.codes[2]);
}

void update(XXH3_state_t* state, std::span<const std::byte> bytes) noexcept {
    XXH3_64bits_update(state, bytes.data(), bytes.size());
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] void update_by_avx2(XXH3_state_t* state,
                                            std::span<const std::byte> bytes) noexcept {
#if XXH_VERSION_NUMBER >= 802
    constexpr auto kAccumulate = XXH3_accumulate_avx2;
#else
    constexpr auto kAccumulate = XXH3_accumulate_512_avx2;
#endif
    XXH3_update(state, reinterpret_cast<const xxh_u8*>(bytes.data()), bytes.size(), kAccumulate,
                XXH3_scrambleAcc_avx2);
}
#else
constexpr auto update_by_avx2 = update;
#endif

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
        const auto bytes = std::span<const std::byte>(some).first(part.size() * kBytes);
        has_avx2() ? update_by_avx2(state, bytes) : update(state, bytes);
        ticks = ticks.subspan(part.size());
    }
}

std::uint64_t DerivedHash::value() const noexcept {
    return XXH3_64bits_digest(std::launder(reinterpret_cast<const XXH3_state_t*>(state_.data())));
}

}  // namespace palpate::data
