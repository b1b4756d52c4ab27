#pragma once

#include <functional>
#include <string>

#include "protocols/session/session.hpp"
#include "data/store/session_store.hpp"
#include "tests/support/studies.hpp"

/// Small studies with a rule, and sessions felt by the simulated hand.
namespace palpate::tests {

inline constexpr const char* kQuestPlusRule = R"(kind = "quest_plus"
trials = 7
nuisance = ["lapse"]
[procedure.model]
family = "normal"
lapse_form = "two_sided"
slope_as = "sd"
[procedure.stimuli]
stimulus = { from = -3, to = 13, step = 2 }
[procedure.parameters]
threshold = { from = 1, to = 9, step = 1 }
sd = [1, 2, 4, 8]
lapse = [0, 0.05]
)";

inline constexpr const char* kStaircaseRule = R"(kind = "staircase"
[[procedure.staircase]]
start = 12
down = 2
step_up = [4, 2]
lowest = 5.5
highest = 15
trials = 4
[[procedure.staircase]]
start = 9
down = 1
step_up = 1
lowest = 5.5
highest = 15
trials = 3
)";

/// Two runs of seven trials and two practice trials, each interval felt for 0.3 s.
[[nodiscard]] std::string adaptive_text(const std::string& rule,
                                        const std::string& kind = "two_interval");

[[nodiscard]] protocols::Protocol adaptive_protocol(const std::string& rule = kQuestPlusRule,
                                                    const std::string& kind = "two_interval");

using RunSession = std::function<void(protocols::Recorder&)>;

/// Opens or resumes the session; `through` is given the recorder, and what runs the session with a
/// port before it.
protocols::SessionEnd run_simulated_through(
    data::Database& database,
    const data::SessionSpec& spec,
    const std::function<void(protocols::Recorder&, const RunSession&)>& through);

/// The same through `wrap(recorder)`.
template <class Wrap>
protocols::SessionEnd run_simulated(data::Database& database,
                                    const data::SessionSpec& spec,
                                    const Wrap& wrap) {
    return run_simulated_through(database, spec,
                                 [&wrap](protocols::Recorder& recorder, const RunSession& run) {
                                     auto&& port = wrap(recorder);
                                     run(port);
                                 });
}

protocols::SessionEnd run_simulated(data::Database& database, const data::SessionSpec& spec);

}  // namespace palpate::tests
