#include "data/store/session_store.hpp"

namespace palpate::data {
namespace {

std::optional<SessionState> state_of(Statement& row) {
    if (!row.step()) {
        return std::nullopt;
    }
    return SessionState{static_cast<std::size_t>(row.integer(0)),
                        std::stoull(row.text(1)),
                        row.integer(2) != 0,
                        row.integer(4) != 0,
                        row.text(3),
                        row.text(5)};
}

/// What was withdrawn, or run as somebody else, is over: its orders were drawn for another key, or
/// are of no use.
constexpr const char* kStates =
    "SELECT session_number, seed, finished OR withdrawn_reason IS NOT NULL OR run_code IS NOT "
    "NULL, secret, EXISTS (SELECT 1 FROM trial WHERE trial.session_id = session.session_id), "
    "session_kind FROM session JOIN study USING (study_id) JOIN participant USING (participant_id) "
    "WHERE study_name = ?1 AND participant_code = ?2";

}  // namespace

std::optional<SessionState> latest_session(Database& database,
                                           std::string_view study,
                                           std::string_view participant) {
    Statement row = database.prepare(std::string(kStates) + " ORDER BY session_number DESC LIMIT 1",
                                     study, participant);
    return state_of(row);
}

std::optional<SessionState> find_session(Database& database,
                                         std::string_view study,
                                         const protocols::SessionKey& key) {
    Statement row = database.prepare(std::string(kStates) + " AND session_number = ?3", study,
                                     key.participant, key.session);
    return state_of(row);
}

std::optional<OtherVersion> other_version(Database& database,
                                          std::string_view study,
                                          std::string_view protocol_sha256,
                                          RunKind kind) {
    Statement row = database.prepare(
        "SELECT protocol_sha256, protocol_toml, (SELECT count(DISTINCT participant_id) FROM "
        "session AS same WHERE same.study_id = session.study_id AND same.session_kind = ?2 AND "
        "EXISTS (SELECT 1 FROM trial WHERE trial.session_id = same.session_id)) FROM trial JOIN "
        "session USING (session_id) JOIN study USING (study_id) WHERE study_name = ?1 AND "
        "session_kind = ?2 ORDER BY trial_id DESC LIMIT 1",
        study, to_string(kind));
    const bool other = row.step() && row.text(0) != protocol_sha256;
    return other ? std::optional(OtherVersion{row.integer(2), row.text(1)}) : std::nullopt;
}

}  // namespace palpate::data
