#pragma once

#include "tests/support/std.hpp"

namespace palpate::tests {

/// What became of random schedules of faults, and how often they broke which law.
struct Tally {
    int schedules = 0;
    int pressed = 0;  ///< in which the motors had a torque
    int tripped = 0;
    std::map<std::string, int> broken{};
    std::string worst{};  ///< the schedules that broke something

    void must(bool kept, const char* law) {
        if (!kept) {
            ++broken[law];
        }
    }
};

}  // namespace palpate::tests
