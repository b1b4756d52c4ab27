#pragma once

#include "tests/bench/method.hpp"
#include "tests/bench/objects.hpp"

namespace palpate::bench {

/// One Newton update of u on a cubic, each waiting for the one before: the unit of all times.
[[nodiscard]] std::unique_ptr<Method<2>> newton_update();

/// The floor, our own methods and the polyline, for one object. New solvers of the engine go here.
[[nodiscard]] Methods<2> own_methods(const Object& object);

/// Whole ticks of a scene, for a path inside the object; beside them one Newton update.
[[nodiscard]] Methods<2> tick_methods(const Object& object);

/// Whole ticks of the study's object on its base line, rigid and soft; of other objects none.
[[nodiscard]] Methods<2> soft_methods(const Object& object);

/// Those that take any curve at all, one that no outline is made of too.
[[nodiscard]] Methods<2> any_curve_methods(const Object& object);

/// Those that take any number of curves.
[[nodiscard]] Methods<2> scaling_methods(const Object& ring);

}  // namespace palpate::bench
