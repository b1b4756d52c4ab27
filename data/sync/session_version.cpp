#include "data/sync/session_version.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "protocols/design/sha256.hpp"

namespace palpate::data {
namespace {

using protocols::sha256_hex;

constexpr std::string_view kAfter = "after trial ";
constexpr std::string_view kBegan = "when as many were begun: ";

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
    Statement row = database.prepare(table.select(owner));
    row.bind(1, id);
    while (row.step()) {
        hashes += sha256_hex(row_bytes(row)) + '\n';
    }
    return hashes;
}

std::vector<TrialVersion> trials_of(Database& database,
                                    const Layout& layout,
                                    std::int64_t session) {
    std::vector<TrialVersion> trials;
    Statement row = database.prepare(
        "SELECT position, attempt, started_utc, slip_decay, heal_decay FROM trial WHERE id = ?1");
    Statement all =
        database.prepare(fmt::format("SELECT {} FROM trial WHERE id = ?1", layout.trial.list()));
    Statement ids = database.prepare(
        "SELECT id, outcome, coalesce(invalid, ''), (SELECT coalesce(sum(trace_chunk.ticks), 0)"
        " FROM trace_chunk WHERE trace_chunk.trial = trial.id) FROM trial WHERE session = ?1"
        " ORDER BY id");
    ids.bind(1, session);
    while (ids.step()) {
        TrialVersion& trial = trials.emplace_back();
        trial.id = ids.integer(0);
        trial.outcome = ids.text(1);
        trial.invalid = ids.text(2);
        trial.ticks = ids.integer(3);
        row.bind(1, trial.id).step();
        trial.key = sha256_hex(row_bytes(row));
        row.reset();
        all.bind(1, trial.id).step();
        std::string content = row_bytes(all);
        all.reset();
        for (const OwnedTable& table : layout.of_trial) {
            content += rows_of(database, table, "trial", trial.id);
        }
        trial.content = sha256_hex(content);
    }
    return trials;
}

std::size_t place_of(std::int64_t id, const std::vector<TrialVersion>& trials) {
    return static_cast<std::size_t>(
        std::count_if(trials.begin(), trials.end(), [id](const auto& t) { return t.id <= id; }));
}

std::vector<std::string> events_of(Database& database, const SessionVersion& session) {
    std::vector<std::string> events;
    Statement row = database.prepare(
        "SELECT coalesce(trial, 0), kind, text, at_utc FROM event WHERE session = ?1 ORDER BY id");
    row.bind(1, session.id);
    while (row.step()) {
        events.push_back(
            sha256_hex(fmt::format("{} {}:{} {} ", place_of(row.integer(0), session.trials),
                                   row.text(1).size(), row.text(1), row.text(3)) +
                       portable_text(row.text(1), row.text(2), session.trials)));
    }
    return events;
}

std::string head_of(Database& database, const Layout& layout, const SessionVersion& session) {
    Statement row = database.prepare(
        fmt::format("SELECT {} FROM session WHERE id = ?1", layout.session.list()));
    row.bind(1, session.id).step();
    std::string head = session.study + ' ' + session.participant + ' ' + row_bytes(row);
    for (const OwnedTable& table : layout.of_session) {
        head += rows_of(database, table, "session", session.id);
    }
    return sha256_hex(head);
}

bool became(const TrialVersion& earlier, const TrialVersion& later) {
    if (earlier.content == later.content) {
        return earlier.invalid.empty() || earlier.invalid == later.invalid;
    }
    return earlier.outcome == "running" && earlier.key == later.key &&
           (later.outcome != "running" || earlier.ticks < later.ticks);
}

/// The number after `start` and the rest from ": " on.
std::optional<std::pair<std::int64_t, std::string>> numbered(const std::string& text,
                                                             std::string_view start) {
    const std::size_t colon = text.find(": ");
    std::int64_t number = 0;
    if (!text.starts_with(start) || colon == std::string::npos ||
        std::from_chars(text.data() + start.size(), text.data() + colon, number).ptr !=
            text.data() + colon) {
        return std::nullopt;
    }
    return std::pair{number, text.substr(colon)};
}

}  // namespace

std::vector<SessionVersion> session_versions(Database& database,
                                             const Layout& layout,
                                             const std::string& file) {
    std::vector<SessionVersion> all;
    Statement row = database.prepare(
        "SELECT session.id, uuid, protocol_sha256, name, code, number, finished,"
        " coalesce(finished_utc, '') FROM session JOIN study ON study.id = study"
        " JOIN participant ON participant.id = participant ORDER BY session.id");
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
        session.finished_utc = row.text(7);
        session.head = head_of(database, layout, session);
        session.trials = trials_of(database, layout, session.id);
        session.events = events_of(database, session);
    }
    return all;
}

bool became(const SessionVersion& earlier, const SessionVersion& later) {
    if (earlier.head != later.head || earlier.trials.size() > later.trials.size() ||
        earlier.events.size() > later.events.size() ||
        (earlier.finished && (!later.finished || earlier.finished_utc != later.finished_utc))) {
        return false;
    }
    for (std::size_t i = 0; i < earlier.trials.size(); ++i) {
        if (!became(earlier.trials[i], later.trials[i])) {
            return false;
        }
    }
    return std::equal(earlier.events.begin(), earlier.events.end(), later.events.begin());
}

std::string portable_text(std::string_view kind,
                          const std::string& text,
                          const std::vector<TrialVersion>& trials) {
    const auto found = kind == "mark" ? numbered(text, kAfter) : std::nullopt;
    return found ? fmt::format("{}{}{}", kBegan, place_of(found->first, trials), found->second)
                 : text;
}

std::string local_text(std::string_view kind,
                       const std::string& portable,
                       const std::vector<std::int64_t>& trials) {
    if (kind != "mark" || !portable.starts_with(kBegan)) {
        return portable;
    }
    const std::string rest = portable.substr(kBegan.size());
    const auto found = numbered(rest, "");
    if (!found || found->first < 0 || found->first > static_cast<std::int64_t>(trials.size())) {
        return portable;
    }
    const auto place = static_cast<std::size_t>(found->first);
    return fmt::format("{}{}{}", kAfter, place == 0 ? 0 : trials[place - 1], found->second);
}

}  // namespace palpate::data
