#pragma once

#include <cstdint>

namespace palpate::engine {

/// What the contact did in one tick. An output only: the friction law keeps no such state.
enum class Mode : std::uint8_t {
    free = 0,        ///< no contact, force zero
    stuck = 1,       ///< the god-object stayed where it was
    slip = 2,        ///< it moved, friction at its dynamic value
    transition = 3,  ///< it moved while mu still relaxes from mu_s to mu_d (Stribeck)
};

}  // namespace palpate::engine
