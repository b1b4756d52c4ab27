#include "tests/support/adaptive.hpp"

#include <optional>

#include "protocols/file/protocol_file.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/sqlite_recorder.hpp"

namespace palpate::tests {

std::string adaptive_text(const std::string& rule, const std::string& kind) {
    const bool two = kind == "two_interval";
    return R"(format = 1
[study]
id = "adaptive"
title = "A small study with a rule"
seed = 5
[apparatus]
start_mm = [0, 45]
[[object]]
name = "reference"
curvature_per_m = 5
[[friction]]
name = "off"
law = "frictionless"
[[friction]]
name = "on"
law = "gos"
mu_s = 0.7
mu_d = 0.5
[response]
kind = ")" +
           kind +
           R"("
question = "Which was more convex?"
confidence = true
[procedure]
varies = "curvature_per_m"
object = "reference"
practice_trials = 2
practice_stimulus = 13
)" + rule +
           R"([[run]]
name = "equal"
friction = "off"
[[run]]
name = "different"
friction = "on"
)" + (two ? "standard_friction = \"off\"\n" : "") +
           R"([invalid]
contact_min_s = 0
path_min_mm = 0
[design]
break_every = 5
[timing]
explore_min_s = 0.1
explore_prompt_s = 0.2
explore_timeout_s = 0.3
gap_s = 0
)";
}

protocols::Protocol adaptive_protocol(const std::string& rule, const std::string& kind) {
    return protocols::parse_protocol(adaptive_text(rule, kind), "p.toml");
}

protocols::SessionEnd run_simulated_through(
    data::Database& database,
    const data::SessionSpec& spec,
    const std::function<void(protocols::Recorder&, const RunSession&)>& through) {
    const data::OpenedSession opened = data::open_session(database, spec);
    protocols::SimulatedApparatus apparatus(
        spec.protocol,
        protocols::DrawnHand(spec.protocol, spec.protocol_hash, spec.key, spec.seed));
    protocols::SimulatedObserver observer(spec.protocol, session_stream(spec),
                                          spec.plan.picture_order,
                                          [&] { return apparatus.hand_is_done(); });
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    std::optional<protocols::SessionEnd> end;
    through(recorder, [&](protocols::Recorder& port) {
        end = run_session(spec.protocol, spec.plan,
                          {.title = spec.protocol.title,
                           .participant = spec.key.participant,
                           .trials = spec.plan.trials.size(),
                           .next = opened.progress.pending().answered(),
                           .simulated = true,
                           .device = "test"},
                          opened.progress,
                          {.apparatus = apparatus, .observer = observer, .recorder = port});
    });
    return end.value();
}

protocols::SessionEnd run_simulated(data::Database& database, const data::SessionSpec& spec) {
    return run_simulated_through(
        database, spec,
        [](protocols::Recorder& recorder, const RunSession& run) { run(recorder); });
}

}  // namespace palpate::tests
