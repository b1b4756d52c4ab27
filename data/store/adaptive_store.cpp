#include "data/store/adaptive_store.hpp"

#include <cmath>

#include <fmt/format.h>

#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::data {

std::string estimates_text(const std::vector<protocols::Estimate>& estimates) {
    const auto number = [](std::optional<double> value) {
        return value && std::isfinite(*value) ? fmt::format("{}", *value == 0.0 ? 0.0 : *value)
                                              : std::string("null");
    };
    std::string text;
    for (const protocols::Estimate& estimate : estimates) {
        text += fmt::format("{}\"{}\":{{\"mean\":{},\"mode\":{}}}", text.empty() ? "" : ",",
                            estimate.name, number(estimate.mean), number(estimate.mode));
    }
    return '{' + text + '}';
}

protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT protocol_toml, protocol_sha256, coalesce(run_code, participant_code), "
        "coalesce(run_number, session_number), seed, secret "
        "FROM session JOIN study USING (study_id) JOIN participant USING (participant_id) WHERE "
        "session.session_id = ?1");
    row.bind(1, session).step();
    const protocols::Protocol protocol = protocols::stored_protocol(row.text(0));
    protocols::AdaptiveRuns runs(
        protocol,
        protocols::session_stream(
            row.text(1), {row.text(2), static_cast<std::size_t>(row.integer(3)), row.text(5)},
            std::stoull(row.text(4))));
    Statement step = database.prepare(
        "SELECT run_number, stimulus, rule_outcome FROM analysis_trial WHERE session_id = ?1"
        " AND counts AND run_trial_number IS NOT NULL ORDER BY trial_id");
    step.bind(1, session);
    while (step.step()) {
        runs.update({.run = static_cast<std::size_t>(step.integer(0)),
                     .stimulus = step.real(1),
                     .outcome = static_cast<std::size_t>(step.integer(2))});
    }
    return runs;
}

}  // namespace palpate::data
