#include "tests/support/adaptive.hpp"

#include "protocols/file/protocol_file.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/trial/servo_apparatus.hpp"

namespace palpate::tests {

std::string adaptive_text(const std::string& rule, const std::string& kind) {
    const std::string text = edited(test_text("adaptive.toml"), {{"KIND", kind}, {"RULE\n", rule}});
    return kind == "two_interval" ? text : replaced(text, "standard_friction = \"off\"\n", "");
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
