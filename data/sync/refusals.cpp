#include "data/sync/refusals.hpp"

#include <limits>

#include <fmt/format.h>

#include "data/store/chain.hpp"

namespace palpate::data {
namespace {

constexpr const char* kTheirSession = "session";

/// How often the session became another's; what was destroyed says no more than that it is the
/// last.
std::int64_t moves_of(const SessionVersion& session) {
    return session.destroyed
             ? std::numeric_limits<std::int64_t>::max()
             : session.database
                   ->first("SELECT count(*) FROM event WHERE session_id = ?1 AND key = ?2",
                           session.id, kIsReally)
                   .integer(0);
}

}  // namespace

void Refusals::read(Postgres& server) {
    for (const auto& row : server.rows(
             "SELECT participant_code FROM palpate.participant_note WHERE key = 'consent' AND "
             "value = '0'")) {
        codes_.insert(*row[0]);
    }
    for (const auto& row : server.rows(
             "SELECT participant_code, max(value) FROM palpate.participant_note WHERE key = "
             "'destroyed' GROUP BY 1")) {
        destroyed_[*row[0]] = *row[1];
    }
    for (const auto& row : server.rows(
             "SELECT split_part(value, ' ', 1), max(split_part(value, ' ', 2)::bigint) FROM "
             "palpate.participant_note AS theirs WHERE key = $1 AND EXISTS (SELECT FROM "
             "palpate.participant_note AS no WHERE no.participant_code = theirs.participant_code "
             "AND no.key = 'consent' AND no.value = '0') GROUP BY 1",
             {kTheirSession})) {
        moves_[*row[0]] = std::stoll(*row[1]);
    }
}

bool Refusals::hold(const SessionVersion& session) const {
    const auto theirs = moves_.find(session.uuid);
    return hold(session.participant) ||
           (theirs != moves_.end() && moves_of(session) <= theirs->second);
}

PostgresRow Refusals::note(const SessionVersion& session) {
    return {session.participant, kTheirSession,
            fmt::format("{} {}", session.uuid, moves_of(session))};
}

}  // namespace palpate::data
