#include "tests/figures/objects.hpp"

namespace palpate::figures {

using engine::Vec2;

Polygons narrow_arch() {
    return {{{-0.05, 0.0}, {0.02, 0.06}, {-0.02, 0.06}, {0.05, 0.0}}};
}

Polygons three_curves() {
    const Vec2 left{-0.042, -0.026};
    const Vec2 top{-0.004, 0.044};
    const Vec2 right{0.044, -0.020};
    return {{left, {-0.050, 0.006}, {-0.030, 0.036}, top},
            {top, {0.024, 0.038}, {0.046, 0.012}, right},
            {right, {0.022, -0.040}, {-0.018, -0.042}, left}};
}

}  // namespace palpate::figures
