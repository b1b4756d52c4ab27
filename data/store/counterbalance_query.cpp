#include "data/store/counterbalance_query.hpp"

#include "data/store/session_lock.hpp"

namespace palpate::data {
namespace {

constexpr const char* kPictures = "SELECT object FROM picture WHERE session = ?1 ORDER BY place";

// Frictions by their first block, if no block has two.
constexpr const char* kFrictions =
    "SELECT friction FROM plan WHERE session = ?1 AND phase = 'main' AND NOT EXISTS"
    " (SELECT 1 FROM plan WHERE session = ?1 AND phase = 'main' GROUP BY block"
    " HAVING count(DISTINCT friction) > 1) GROUP BY friction ORDER BY min(position)";

std::vector<std::string> order_of(Database& database, const char* sql, std::int64_t session) {
    Statement row = database.prepare(sql);
    row.bind(1, session);
    std::vector<std::string> order;
    while (row.step()) {
        order.push_back(row.text(0));
    }
    return order;
}

LevelOrders orders_of(Database& database,
                      const char* sql,
                      std::string_view study,
                      const protocols::SessionKey& key) {
    const Snapshot view(database);
    LevelOrders orders;
    Statement other = database.prepare(
        "SELECT session.id, code, EXISTS (SELECT 1 FROM trial WHERE trial.session = session.id)"
        " FROM session JOIN study ON study.id = study JOIN participant ON participant.id ="
        " participant WHERE name = ?1 AND code <> ?2 AND kind = 'real' ORDER BY code, number");
    other.bind(1, study).bind(2, key.participant);
    std::string last;
    while (other.step()) {
        const bool begun = other.integer(2) != 0;
        if (other.text(1) != last && (begun || SessionLock::held(database, other.integer(0)))) {
            last = other.text(1);
            orders.others.push_back(order_of(database, sql, other.integer(0)));
        }
    }
    Statement own = database.prepare(
        "SELECT session.id FROM session JOIN study ON study.id = study"
        " JOIN participant ON participant.id = participant WHERE name = ?1 AND code = ?2"
        " AND EXISTS (SELECT 1 FROM trial WHERE trial.session = session.id)"
        " ORDER BY number = ?3 DESC, number, session.id LIMIT 1");
    own.bind(1, study).bind(2, key.participant).bind(3, static_cast<std::int64_t>(key.session));
    if (own.step()) {
        orders.own = order_of(database, sql, own.integer(0));
    }
    return orders;
}

}  // namespace

LevelOrders picture_orders(Database& database,
                           std::string_view study,
                           const protocols::SessionKey& key) {
    return orders_of(database, kPictures, study, key);
}

LevelOrders friction_orders(Database& database,
                            std::string_view study,
                            const protocols::SessionKey& key) {
    return orders_of(database, kFrictions, study, key);
}

}  // namespace palpate::data
