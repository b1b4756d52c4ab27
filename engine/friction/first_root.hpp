#pragma once

#include "engine/friction/cone_forms.hpp"

namespace palpate::engine {

/// The first place of a net where A <= 0 or B <= 0.
struct FirstRoot {
    enum class Answer : std::uint8_t {
        none,     ///< both are > 0 all the way
        found,    ///< at z
        unclear,  ///< the digits do not tell
    };
    Answer answer = Answer::none;
    double z = 0.0;     ///< in [0, 1]
    double rest = 1.0;  ///< 1 - z, with all its digits
    double blur = 0.0;  ///< what rounding leaves open of z
};

/// Isolates it with a proof, by halving: where the coefficients of A and of B change sign once at
/// most, beyond all rounding, there is one root at most (Descartes' rule), and a bracket closes on
/// it. In doubles the answer may be `unclear`; in Twice it never is: what is zero to 28 digits is
/// zero, and in the cone.
template <class Real>
[[nodiscard]] FirstRoot first_root(const ConeNet<Real>& net) noexcept;

}  // namespace palpate::engine
