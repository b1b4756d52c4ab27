#pragma once

#include <cstdint>
#include <span>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {

/// XXH3 (64 bits, seed 0, xxHash 0.8) over the columns that a chunk does not hold as they were: for every
/// tick, in this order and without gaps, little endian,
///
///     hip, cp, go, force, command (x, y: f64 each), normal_force, tangential_force, mu, parameter (f64),
///     feature (i16), mode (u8), flags & (skipped | held) (u8), zero (u32)          120 bytes a tick
///
/// Written by the recorder from the servo's own records. A replay that gives another hash is none.
[[nodiscard]] std::uint64_t derived_hash(std::span<const engine::TickRecord> ticks) noexcept;

/// The flags that the scene sets; the others are the safety chain's and the device's.
inline constexpr unsigned kSceneFlags = engine::tick_skipped | engine::tick_held;

}  // namespace palpate::data
