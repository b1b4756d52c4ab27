#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate::engine {

/// Bytes that go to a board, or come from it, in one piece.
struct BoardBytes {
    std::array<std::uint8_t, 64> bytes{};
    std::size_t size = 0;

    /// The bytes that are in use; valid while this lives.
    [[nodiscard]] std::span<const std::uint8_t> view() const noexcept {
        return {bytes.data(), size};
    }
    /// One more. @pre size < 64
    void add(std::uint8_t byte) noexcept { bytes[size++] = byte; }
};

}  // namespace palpate::engine
