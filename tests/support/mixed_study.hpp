#pragma once

#include "tests/support/process.hpp"
#include "tests/support/short_text.hpp"

namespace palpate::tests {

inline void run_headless(const TemporaryFolder& folder, const std::string& text) {
    std::ofstream(folder.file("p.toml")) << text;
    static_cast<void>(palpate_command({"run", folder.file("p.toml"), "--participant", "P1", "--db",
                                       folder.file("a.sqlite"), "--headless"}));
}

/// Two sessions: pictures, answers with confidence and faults; a rule with two intervals. Short
/// trials.
inline std::string mixed_study(const TemporaryFolder& folder) {
    const std::pair<std::string, std::string> quick{"explore_min_s = 2", "explore_min_s = 0.2"};
    run_headless(folder, tests::short_text("shape_friction_demo",
                                           {quick,
                                            {"explore_prompt_s = 30", "explore_prompt_s = 1"},
                                            {"explore_timeout_s = 45", "explore_timeout_s = 2"},
                                            {"break_every = 0", "break_every = 3"},
                                            {"dead_man = false", "speed_limit_m_per_s = 0.172"}}) +
                             "\n[response]\nconfidence = true\n[invalid]\ncontact_min_s = "
                             "0.1\npath_min_mm = 160\nmax_requeues = 1\n");
    run_headless(folder, tests::short_text("friction_threshold",
                                           {quick,
                                            {"explore_prompt_s = 10", "explore_prompt_s = 0.4"},
                                            {"explore_timeout_s = 15", "explore_timeout_s = 0.5"},
                                            {"practice_trials = 4", "practice_trials = 1"},
                                            {"trials = 40\naverage = 6", "trials = 2"},
                                            {"trials = 40\naverage = 6", "trials = 2"},
                                            {"break_min_s = 30", "break_min_s = 0"},
                                            {"gap_s = 1", "gap_s = 0"}}) +
                             "\n[invalid]\ncontact_min_s = 0\npath_min_mm = 0\n");
    return folder.file("a.sqlite");
}

}  // namespace palpate::tests
