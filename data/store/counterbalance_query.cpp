#include "data/store/counterbalance_query.hpp"

namespace palpate::data {
namespace {

std::vector<std::string> pictures_of(Database& database, std::int64_t session) {
    Statement row =
        database.prepare("SELECT object FROM picture WHERE session = ?1 ORDER BY place");
    row.bind(1, session);
    std::vector<std::string> order;
    while (row.step()) {
        order.push_back(row.text(0));
    }
    return order;
}

}  // namespace

PictureOrders picture_orders(Database& database,
                             std::string_view study,
                             const protocols::SessionKey& key) {
    const Snapshot view(database);
    PictureOrders orders;
    Statement other = database.prepare(
        // SQLite takes the other columns from the row of the minimum.
        "SELECT session.id, min(number) FROM session JOIN study ON study.id = study"
        " JOIN participant ON participant.id = participant"
        " WHERE name = ?1 AND code <> ?2 AND kind = 'real' GROUP BY code ORDER BY code");
    other.bind(1, study).bind(2, key.participant);
    while (other.step()) {
        orders.others.push_back(pictures_of(database, other.integer(0)));
    }
    Statement own = database.prepare(
        "SELECT session.id FROM session JOIN study ON study.id = study"
        " JOIN participant ON participant.id = participant WHERE name = ?1 AND code = ?2"
        " ORDER BY number = ?3 DESC, number, session.id LIMIT 1");
    own.bind(1, study).bind(2, key.participant).bind(3, static_cast<std::int64_t>(key.session));
    if (own.step()) {
        orders.own = pictures_of(database, own.integer(0));
    }
    return orders;
}

}  // namespace palpate::data
