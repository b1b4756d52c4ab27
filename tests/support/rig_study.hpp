#pragma once

#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/test_text.hpp"

/// The study of a commissioned rig's first session, and the words that run it.
namespace palpate::tests {

inline std::string study_of_rig(const TemporaryFolder& folder) {
    const std::string soft =
        replaced(four_trials(),
                 "stiffness_n_per_m = 1000\nforce_limit_n = 10",  // its handle stays at home
                 "start_radius_mm = 0\nstiffness_n_per_m = 200\nforce_limit_n = 1.5");
    const std::string text = replaced(soft, "break_every = 0", "break_every = 1");
    std::ofstream(folder.file("p.toml")) << text;
    return folder.file("p.toml");
}

inline std::string ran_words(const TemporaryFolder& folder, const std::string& device) {
    return "run '" + study_of_rig(folder) + "' --participant P1 --db '" + folder.file("d.sqlite") +
           "' --windowed --device " + device;
}

}  // namespace palpate::tests
