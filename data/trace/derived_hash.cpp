#include <bit>
#include <new>

#include "data/trace/chunk.hpp"

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
static_assert(sizeof(TickRecord) == 208, "a tick has no gaps");

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
    has_avx2() ? update_by_avx2(state, std::as_bytes(ticks)) : update(state, std::as_bytes(ticks));
}

std::uint64_t DerivedHash::value() const noexcept {
    return XXH3_64bits_digest(std::launder(reinterpret_cast<const XXH3_state_t*>(state_.data())));
}

}  // namespace palpate::data
