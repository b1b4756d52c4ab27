#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/chain.hpp"
#include "data/store/session_lock.hpp"
#include "data/store/session_store.hpp"

namespace palpate::data {
namespace {

constexpr const char* kPictures =
    "SELECT picture_object FROM picture WHERE session_id = ?1 ORDER BY picture_place";

// Frictions by their first block, if no block has two.
constexpr const char* kFrictions =
    "SELECT friction FROM plan WHERE session_id = ?1 AND phase = 'main' AND NOT EXISTS (SELECT 1 "
    "FROM plan WHERE session_id = ?1 AND phase = 'main' GROUP BY block HAVING count(DISTINCT "
    "friction) > 1) GROUP BY friction ORDER BY min(plan_position)";

}  // namespace

std::vector<ChainBreak> study_breaks(Database& database, std::int64_t study) {
    std::vector<ChainBreak> breaks;
    const auto expect = [&](const char* what, std::string stored, std::string wanted) {
        if (stored != wanted) {
            breaks.push_back({0, what, std::move(stored), std::move(wanted)});
        }
    };
    Statement row = database.prepare(
        "SELECT protocol_sha256, study_name, study_title, protocol_toml FROM study WHERE study_id "
        "= ?1",
        study);
    if (!row.step()) {
        return breaks;
    }
    const std::string text = row.text(3);
    expect("study.protocol_sha256", row.text(0), sha256_hex(text));
    try {
        const protocols::Protocol protocol = protocols::stored_protocol(text);
        expect("study.study_name", row.text(1), protocol.id);
        expect("study.study_title", row.text(2), protocol.title);
    } catch (const protocols::ProtocolError& e) {
        breaks.push_back({0, "study.protocol_toml", e.what(), "a protocol"});
    }
    return breaks;
}

void require_study(Database& database, std::int64_t study) {
    const std::vector<ChainBreak> breaks = study_breaks(database, study);
    if (!breaks.empty()) {
        throw StoreError(fmt::format(
            "{}: the study {} is not what it was: {} is damaged or was changed; go on in a copy "
            "from before that",
            database.file(),
            database.first("SELECT study_name FROM study WHERE study_id = ?1", study).text(0),
            breaks[0].what));
    }
}

LevelOrders orders_of(Database& database,
                      Balanced what,
                      std::string_view study,
                      const protocols::SessionKey& key,
                      std::string_view kind) {
    const Snapshot view(database);
    const auto order_of = [&](std::int64_t session) {
        return texts(
            database.prepare(what == Balanced::pictures ? kPictures : kFrictions, session));
    };
    LevelOrders orders;
    Statement other = database.prepare(
        "SELECT session.session_id, participant_code, EXISTS (SELECT 1 FROM trial WHERE "
        "trial.session_id = session.session_id) FROM session JOIN study USING (study_id) JOIN "
        "participant USING (participant_id) WHERE study_name = ?1 AND participant_code <> ?2 AND "
        "session_kind = 'real' AND withdrawn_reason IS NULL ORDER BY participant_code, "
        "session_number",
        study, key.participant);
    std::string last;
    while (other.step()) {
        const bool begun = other.integer(2) != 0;
        if (other.text(1) != last && (begun || SessionLock::held(database, other.integer(0)))) {
            last = other.text(1);
            orders.others.push_back(order_of(other.integer(0)));
        }
    }
    Statement own = database.prepare(
        "SELECT session.session_id FROM session JOIN study USING (study_id) JOIN participant USING "
        "(participant_id) WHERE study_name = ?1 AND participant_code = ?2 AND EXISTS (SELECT 1 "
        "FROM trial WHERE trial.session_id = session.session_id) AND (session_number = ?3 OR ?4 <> "
        "'real' OR (session_kind = 'real' AND withdrawn_reason IS NULL)) ORDER BY session_number = "
        "?3 DESC, session_number, session.session_id LIMIT 1",
        study, key.participant, key.session, kind);
    if (own.step()) {
        orders.own = order_of(own.integer(0));
    }
    return orders;
}

}  // namespace palpate::data
