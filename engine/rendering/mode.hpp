#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpate::engine {

/// What the contact did in one tick. An output only: the friction law keeps no such state.
enum class Mode : std::uint8_t {
    free = 0,        ///< no contact, force zero
    stuck = 1,       ///< the god-object stayed where it was
    slip = 2,        ///< it moved, friction at its dynamic value
    transition = 3,  ///< it moved while mu still relaxes from mu_s to mu_d (Stribeck)
};

/// "free", "stuck", "slip", "transition"; "?" for a byte that is none of them.
[[nodiscard]] constexpr std::string_view to_string(Mode mode) noexcept {
    constexpr std::array<std::string_view, 4> kNames{"free", "stuck", "slip", "transition"};
    const auto number = static_cast<std::size_t>(mode);
    return number < kNames.size() ? kNames[number] : "?";
}

}  // namespace palpate::engine
