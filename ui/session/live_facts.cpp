#include "ui/session/live_facts.hpp"

#include <algorithm>
#include <filesystem>

#include "protocols/session/trust.hpp"

namespace palpate::ui {
namespace {

std::string fact_of(const OpenedApparatus& felt, std::string_view key) {
    const auto fact = std::ranges::find(felt.opening, key, &OpeningFact::key);
    return fact == felt.opening.end() ? "" : fact->value;
}

}  // namespace

LiveFacts live_facts(const RigSpec& spec,
                     const OpenedApparatus& felt,
                     data::Database& database,
                     const data::OpenedSession& opened) {
    data::Statement row =
        database.first("SELECT uuid FROM session WHERE session_id = ?1", opened.id);
    const auto calibration = std::ranges::find(felt.provenance, "calibration name",
                                               [](const auto& p) { return p.first; });
    return {.uuid = std::string(row.text(0)),
            .file = std::filesystem::absolute(database.file()).string(),
            .kind = std::string(to_string(spec.kind)),
            .participant = spec.key.participant,
            .number = spec.key.session,
            .operator_name = spec.operator_name,
            .device = felt.port->device_name(),
            .calibration = calibration == felt.provenance.end() ? "" : calibration->second,
            .check = fact_of(felt, protocols::kRigCheck),
            .guard = fact_of(felt, "device watchdog"),
            .round_trip_us =
                felt.round_trip > 0.0 ? std::optional(1e6 * felt.round_trip) : std::nullopt,
            .gives_force = gives_force(spec.device.kind),
            .answered = opened.progress.pending().answered(),
            .left = opened.progress.pending().order().size()};
}

}  // namespace palpate::ui
