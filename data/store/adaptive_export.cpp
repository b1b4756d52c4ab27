#include "data/store/adaptive_export.hpp"

#include <fmt/format.h>

#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::data {

namespace {

std::string responses_of(Database& database, std::int64_t session, std::int64_t run) {
    std::string text = "stimulus,response\n";
    Statement step = database.prepare(
        "SELECT presentation.stimulus, adaptive_step.rule_outcome FROM adaptive_step JOIN trial "
        "USING (trial_id) JOIN presentation ON presentation.trial_id = trial.trial_id AND "
        "presentation.stimulus IS NOT NULL JOIN adaptive_plan USING (session_id, plan_position) "
        "WHERE trial.session_id = ?1 AND adaptive_plan.run_number = ?2 AND trial.invalid_reason IS "
        "NULL ORDER BY trial.trial_id");
    step.bind(1, session).bind(2, run);
    while (step.step()) {
        text += fmt::format("{},{}\n", step.real(0), step.integer(1));
    }
    return text;
}

}  // namespace

ExportedRun exported_run(Database& database, std::int64_t session, std::int64_t run) {
    Statement row = database.prepare(
        "SELECT protocol_toml, protocol_sha256, coalesce(run_code, participant_code), "
        "coalesce(run_number, session_number), seed, secret "
        "FROM session JOIN study USING (study_id) JOIN participant USING (participant_id) WHERE "
        "session.session_id = ?1");
    const bool there = row.bind(1, session).step();
    const protocols::Protocol protocol =
        there ? protocols::stored_protocol(row.text(0)) : protocols::Protocol{};
    if (!protocol.procedure || run < 0 || run >= static_cast<std::int64_t>(protocol.runs.size())) {
        throw StoreError(fmt::format("{}: there is no run {} of a rule in session {}",
                                     database.file(), run, session));
    }
    ExportedRun made;
    const protocols::StreamKey session_key = protocols::session_stream(
        row.text(1), {row.text(2), static_cast<std::size_t>(row.integer(3)), row.text(5)},
        std::stoull(row.text(4)));
    made.procedure =
        protocol.procedure->rule.text +
        fmt::format("\n[stream]\norigin = \"{}\"\n",
                    stream_origin(run_key(session_key, static_cast<std::size_t>(run))));
    made.responses = responses_of(database, session, run);
    return made;
}

}  // namespace palpate::data
