#include "data/store/resume_policy.hpp"

#include <charconv>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/store/chain.hpp"
#include "data/store/people.hpp"

namespace palpate::data {
namespace {

constexpr std::string_view kPart = "part ";

template <class Number>
const char* read(const char* from, const char* end, Number& number) {
    return std::from_chars(from, end, number).ptr;
}

std::string part_name(std::size_t part) {
    return part == 0 ? std::string("the practice") : fmt::format("block {}", part);
}

}  // namespace

std::vector<Redo> redos_of(Database& database, std::int64_t session) {
    std::vector<Redo> redos;
    Statement row = database.prepare(
        "SELECT text FROM event WHERE session_id = ?1 AND event_kind = 'redo' ORDER BY event_id");
    row.bind(1, session);
    while (row.step()) {
        const auto note = read_mark(database, session, row.text(0));
        if (!note || !note->reason.starts_with(kPart)) {
            continue;
        }
        Redo redo{.after = note->after};
        const char* const end = note->reason.data() + note->reason.size();
        read(note->reason.data() + kPart.size(), end, redo.part);
        redos.push_back(redo);
    }
    return redos;
}

bool begin_again(Database& database,
                 std::int64_t session,
                 Resume how,
                 protocols::PendingTrials& pending) {
    if (how == Resume::go_on || pending.empty()) {
        return false;
    }
    const std::size_t part = how == Resume::redo_practice ? 0 : pending.part_of(pending.next());
    const std::string reason = fmt::format("{} was run again", part_name(part));
    std::vector<std::int64_t> trials;
    Statement row = database.prepare(
        "SELECT trial.trial_id, plan_position FROM trial JOIN response USING (trial_id) WHERE "
        "session_id = ?1 AND invalid_reason IS NULL ORDER BY trial.trial_id");
    row.bind(1, session);
    while (row.step()) {
        if (pending.part_of(static_cast<std::size_t>(row.integer(1))) == part) {
            trials.push_back(row.integer(0));
        }
    }
    row.reset();
    if (trials.empty()) {
        return false;
    }
    Statement mark = database.prepare("UPDATE trial SET invalid_reason = ?2 WHERE trial_id = ?1");
    const auto event = [&](std::string_view kind, std::optional<std::int64_t> trial,
                           std::string_view what) {
        add_event(database, {.session = session,
                             .trial = trial,
                             .kind = kind,
                             .text = after_attempts(database, session, what)});
    };
    for (const std::int64_t trial : trials) {
        mark.bind(1, trial).bind(2, reason).run();
        event("mark", trial, reason);
    }
    event("redo", std::nullopt,
          fmt::format("part {}: {} is run again from its first trial, {} not count", part,
                      part_name(part), counted(trials.size(), "answer does", "answers do")));
    pending.begin_again(part);
    return true;
}

protocols::PendingTrials what_is_left(Database& database,
                                      std::int64_t session,
                                      protocols::PendingTrials pending) {
    std::vector<Redo> redos = redos_of(database, session);
    const auto again = [&](std::optional<std::int64_t> before) {
        while (!redos.empty() && (!before || redos.front().after < *before)) {
            pending.begin_again(redos.front().part);
            redos.erase(redos.begin());
        }
    };
    Statement row = database.prepare(
        "SELECT plan_position, outcome, response.trial_id IS NOT NULL, invalid_reason IS NULL, "
        "trial.trial_id FROM trial LEFT JOIN response USING (trial_id) WHERE session_id = ?1 ORDER "
        "BY trial.trial_id");
    row.bind(1, session);
    while (row.step()) {
        again(row.integer(4));
        const bool answered = row.integer(2) != 0;
        if (answered || row.text(1) == to_string(protocols::Outcome::faulted)) {
            pending.note(static_cast<std::size_t>(row.integer(0)),
                         answered ? protocols::Outcome::complete : protocols::Outcome::faulted,
                         row.integer(3) != 0);
        }
    }
    again(std::nullopt);
    return pending;
}

}  // namespace palpate::data
