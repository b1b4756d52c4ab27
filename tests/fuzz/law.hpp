#pragma once

#include <cstdio>
#include <cstdlib>

namespace palpate::fuzz {

/// Ends the program, with what was broken, if a law does not hold.
inline void demand(bool holds, const char* law) {
    if (!holds) {
        std::fprintf(stderr, "broken: %s\n", law);
        std::abort();
    }
}

}  // namespace palpate::fuzz
