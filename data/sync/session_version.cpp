#include "data/sync/session_version.hpp"

#include <algorithm>
#include <ranges>
#include <set>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/chain.hpp"

namespace palpate::data {
namespace {

OwnedTable without(const TableManual& table, const std::set<std::string>& left) {
    OwnedTable owned{.name = table.name, .columns = {}};
    for (const ColumnManual& column : table.columns) {
        if (!left.contains(column.name)) {
            owned.columns.push_back(column.name);
        }
    }
    return owned;
}

/// Columns of a session by when they are set.
void split_session(Layout& layout) {
    const std::set<std::string> at_end{"finished", "finished_utc", "seal", "seal_events"};
    const std::set<std::string> repaired{"session_number", "run_code", "run_number",
                                         "withdrawn_reason"};
    layout.session = without(*find_table("session"),
                             {"session_id", "study_id", "participant_id", "newest_seal"});
    layout.session_end = layout.session_repairs = layout.session;
    std::erase_if(layout.session.columns,
                  [&](const auto& c) { return at_end.contains(c) || repaired.contains(c); });
    std::erase_if(layout.session_repairs.columns,
                  [&](const auto& c) { return !repaired.contains(c); });
    std::erase_if(layout.session_end.columns, [&](const auto& c) { return !at_end.contains(c); });
}

/// The row's values with their types and sizes: no two rows give the same bytes.
std::string row_bytes(const Statement& row) {
    std::string bytes;
    for (int column = 0; column < row.columns(); ++column) {
        std::string value = row.text(column);
        if (row.type(column) == 2) {
            const double real = row.real(column);
            value.assign(reinterpret_cast<const char*>(&real), sizeof real);
        }
        bytes += fmt::format("{}:{}:", row.type(column), value.size()) + value;
    }
    return bytes;
}

std::string rows_of(Database& database,
                    const OwnedTable& table,
                    std::string_view owner,
                    std::int64_t id) {
    std::string hashes = table.name + '\n';
    for (const Statement& row : database.prepare(table.select(owner), id)) {
        hashes += sha256_hex(row_bytes(row)) + '\n';
    }
    return hashes;
}

std::vector<TrialVersion> trials_of(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT trial_id, outcome, coalesce(invalid_reason, ''), (SELECT "
        "coalesce(sum(trace_chunk.ticks), 0) FROM trace_chunk WHERE trace_chunk.trial_id = "
        "trial.trial_id) FROM trial WHERE session_id = ?1 ORDER BY trial_id",
        session);
    return row.all([](const Statement& one) {
        return TrialVersion{.id = one.integer(0),
                            .outcome = one.text(1),
                            .invalid = one.text(2),
                            .ticks = one.integer(3)};
    });
}

void hash_trials(Database& database, const Layout& layout, std::vector<TrialVersion>& trials) {
    Statement row = database.prepare(
        "SELECT plan_position, attempt, started_utc FROM trial WHERE trial_id = ?1");
    Statement all = database.prepare(layout.trial.select("trial_id"));
    for (TrialVersion& trial : trials) {
        row.bind(1, trial.id).step();
        trial.key = sha256_hex(row_bytes(row));
        row.reset();
        all.bind(1, trial.id).step();
        std::string content = row_bytes(all);
        all.reset();
        for (const OwnedTable& table : layout.of_trial) {
            content += rows_of(database, table, "trial_id", trial.id);
        }
        trial.content = sha256_hex(content);
    }
}

std::size_t place_of(std::int64_t id, const std::vector<TrialVersion>& trials) {
    return static_cast<std::size_t>(
        std::count_if(trials.begin(), trials.end(), [id](const auto& t) { return t.id <= id; }));
}

void hash_events(Database& database, const Layout& layout, SessionVersion& session) {
    Statement trial = database.prepare(
        "SELECT event_id, coalesce(trial_id, 0), at_utc || ' ' || at_ns FROM event WHERE "
        "session_id = ?1 ORDER BY event_id");
    Statement row = database.prepare(layout.event.select("event_id"));
    trial.bind(1, session.id);
    while (trial.step()) {
        row.bind(1, trial.integer(0)).step();
        session.moments.push_back(trial.text(2));
        session.events.push_back(sha256_hex(
            fmt::format("{} ", place_of(trial.integer(1), session.trials)) + row_bytes(row)));
        row.reset();
    }
}

std::string session_row(Database& database, const OwnedTable& part, std::int64_t id) {
    return row_bytes(database.first(part.select("session_id"), id));
}

std::string head_of(Database& database, const Layout& layout, const SessionVersion& session) {
    std::string head =
        fmt::format("{} {} {} ", session.study, session.run_code, session.run_number) +
        row_bytes(database.first(
            "SELECT study_name, study_title, protocol_toml FROM study WHERE protocol_sha256 = ?1",
            session.study)) +
        session_row(database, layout.session, session.id);
    for (const OwnedTable& table : layout.of_session) {
        head += rows_of(database, table, "session_id", session.id);
    }
    return sha256_hex(head);
}

/// @param noted  the later one has more events: a mark can be taken back by one
bool became(const TrialVersion& earlier, const TrialVersion& later, bool noted) {
    if (earlier.content == later.content) {
        return noted || earlier.invalid.empty() || earlier.invalid == later.invalid;
    }
    return earlier.outcome == "running" && earlier.key == later.key &&
           (later.outcome != "running" || earlier.ticks < later.ticks);
}

/// Whatever the seals: the same was run and noted, and in `later` perhaps more.
bool same_but_seals(const SessionVersion& earlier, const SessionVersion& later) {
    return earlier.head == later.head && earlier.moments.size() <= later.moments.size() &&
           std::equal(earlier.moments.begin(), earlier.moments.end(), later.moments.begin()) &&
           earlier.trials.size() <= later.trials.size() && earlier.finished <= later.finished &&
           std::equal(earlier.trials.begin(), earlier.trials.end(), later.trials.begin(),
                      [](const TrialVersion& one, const TrialVersion& other) {
                          return one.key == other.key &&
                                 (one.outcome == other.outcome || one.outcome == "running") &&
                                 one.ticks <= other.ticks;
                      });
}

}  // namespace

std::string OwnedTable::list() const {
    return fmt::format("{}", fmt::join(columns, ", "));
}

std::string OwnedTable::select(std::string_view owner) const {
    return fmt::format("SELECT {} FROM {} WHERE {} = ?1 ORDER BY {}", list(), name, owner,
                       fmt::join(std::views::iota(std::size_t{1}, columns.size() + 1), ", "));
}

Layout catalogue_layout() {
    static const std::set<std::string> own{"study", "participant", "session", "trial", "event"};
    Layout layout;
    split_session(layout);
    layout.trial = without(*find_table("trial"), {"trial_id", "session_id", "invalid_reason"});
    layout.event = without(*find_table("event"), {"event_id", "session_id", "trial_id"});
    for (const TableManual& table : catalogue()) {
        if (table.view || own.contains(table.name)) {
            continue;
        }
        if (table.find("trial_id") != nullptr) {
            layout.of_trial.push_back(without(table, {"trial_id"}));
        } else if (table.find("session_id") != nullptr) {
            layout.of_session.push_back(without(table, {"session_id"}));
        }
    }
    layout.trace_column = without(*find_table("trace_column"), {});
    for (auto* part : {&layout.of_trial, &layout.of_session}) {
        std::ranges::sort(*part, {}, &OwnedTable::name);
    }
    return layout;
}

std::string called(const SessionVersion& session) {
    return fmt::format("{}, participant {}, session {} ({})", session.study_name,
                       session.participant, session.number, session.uuid);
}

std::vector<SessionVersion> session_versions(Database& database,
                                             const Layout& layout,
                                             const std::string& file,
                                             bool hashed) {
    std::vector<SessionVersion> all;
    Statement row = database.prepare(
        "SELECT session.session_id, uuid, protocol_sha256, study_name, participant_code, "
        "session_number, finished, coalesce(run_code, participant_code), coalesce(run_number, "
        "session_number), EXISTS (SELECT 1 FROM event WHERE event.session_id = session.session_id "
        "AND event_kind = 'mark' AND key = ?1), (SELECT count(*) FROM event WHERE event.session_id "
        "= session.session_id AND key = ?1 AND text <> 'detail ' || ?1) FROM session JOIN study "
        "USING (study_id) JOIN "
        "participant USING (participant_id) ORDER BY session.session_id",
        kDestroyed);
    while (row.step()) {
        SessionVersion& session = all.emplace_back();
        session.file = file;
        session.database = &database;
        session.id = row.integer(0);
        session.uuid = row.text(1);
        session.study = row.text(2);
        session.study_name = row.text(3);
        session.participant = row.text(4);
        session.number = row.integer(5);
        session.finished = row.integer(6) != 0;
        session.run_code = row.text(7);
        session.run_number = row.integer(8);
        session.destroyed = row.integer(9) != 0;
        session.destructions = static_cast<std::size_t>(row.integer(10));
        session.trials = trials_of(database, session.id);
        if (hashed) {
            session.end = sha256_hex(session_row(database, layout.session_end, session.id));
            session.head = head_of(database, layout, session);
            hash_trials(database, layout, session.trials);
            hash_events(database, layout, session);
        }
    }
    return all;
}

bool became(const SessionVersion& earlier, const SessionVersion& later) {
    if (earlier.destroyed || later.destroyed) {  // of two the order of files decides nothing
        const bool theirs = earlier.participant == later.participant;
        return later.destroyed && theirs && (!earlier.destroyed || earlier.events <= later.events);
    }
    if (earlier.destructions != later.destructions) {
        return earlier.destructions < later.destructions && same_but_seals(earlier, later);
    }
    if (earlier.head != later.head || earlier.trials.size() > later.trials.size() ||
        earlier.events.size() > later.events.size() ||
        (earlier.finished && earlier.end != later.end)) {
        return false;
    }
    for (std::size_t i = 0; i < earlier.trials.size(); ++i) {
        if (!became(earlier.trials[i], later.trials[i],
                    later.events.size() > earlier.events.size())) {
            return false;
        }
    }
    return std::equal(earlier.events.begin(), earlier.events.end(), later.events.begin());
}

}  // namespace palpate::data
