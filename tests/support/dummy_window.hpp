#pragma once

#include <cstdlib>

namespace palpate::tests {

/// Windows of this program are drawn into memory from now on: no display is needed, and none is
/// used.
inline void draw_into_memory() {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
}

}  // namespace palpate::tests
