#pragma once

#include "protocols/session/session.hpp"
#include "tests/support/studies.hpp"
#include "tests/support/test_text.hpp"

/// Small studies with a rule, and sessions felt by the simulated hand.
namespace palpate::tests {

inline const std::string kQuestPlusRule = test_text("procedures/rule_quest_plus.toml");
inline const std::string kStaircaseRule = test_text("procedures/rule_staircases.toml");

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
