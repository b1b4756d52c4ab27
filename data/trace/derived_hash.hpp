#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/realtime/tick_record.hpp"

namespace palpate::data {

/// XXH3 (64 bits, seed 0, xxHash 0.8) over the ticks as the servo recorded them, 208 bytes a tick
/// as TickRecord lies in memory, little endian, without gaps:
///
///     tick, time_ns (i64); hip, cp, go, force, command (x, y, z), normal_force, tangential_force,
///     mu, u, v (f64); counts (3), codes (3) (i32); lateness_us (f32); segment (i16); mode, flags
///     (u8)
///
/// A chunk holds only some of that. A reading that gives another hash is not what the servo had.
[[nodiscard]] std::uint64_t derived_hash(std::span<const engine::TickRecord> ticks) noexcept;

/// The same, some ticks at a time.
class DerivedHash {
public:
    /// Of no tick yet; value() may be asked for at any time, and add() go on after it.
    DerivedHash() noexcept;
    void add(std::span<const engine::TickRecord> ticks) noexcept;
    [[nodiscard]] std::uint64_t value() const noexcept;

private:
    alignas(64) std::array<std::byte, 576> state_;  ///< an XXH3_state_t
};

}  // namespace palpate::data
