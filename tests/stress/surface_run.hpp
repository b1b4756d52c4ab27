#pragma once

#include "tests/stress/stress_run.hpp"
#include "tests/stress/surface_cases.hpp"

/// One random hand over one random surface.
namespace palpate::stress {

[[nodiscard]] std::optional<Breach> feel(const SurfaceCase& c, Tally& tally, bool watch);

}  // namespace palpate::stress
