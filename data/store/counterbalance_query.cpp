#include "data/store/counterbalance_query.hpp"

#include "data/store/session_lock.hpp"

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
