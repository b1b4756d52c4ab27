#include "data/analysis/exclusion.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/design/factorial.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::data {
namespace {

using protocols::ExclusionSpec;
using protocols::Protocol;

using People = std::map<std::string, Judgement>;

void count_answers(Database& database, std::int64_t study, std::string_view kind, People& people) {
    Statement session = database.prepare(
        "SELECT participant_code, sum(finished = 0) FROM session JOIN participant USING "
        "(participant_id) WHERE study_id = ?1 AND session_kind = ?2 GROUP BY participant_code",
        study, kind);
    while (session.step()) {
        Judgement& one = people[session.text(0)];
        one.participant = session.text(0);
        one.unfinished = session.integer(1);
    }
    Statement row = database.prepare(
        "SELECT participant_code, count(*), sum(invalid_reason IS NOT NULL), sum(invalid_reason IS "
        "NULL AND correct), sum(invalid_reason IS NULL AND outcome = 'timed_out') FROM trial JOIN "
        "response USING (trial_id) JOIN plan USING (session_id, plan_position) JOIN session USING "
        "(session_id) JOIN participant USING (participant_id) WHERE study_id = ?1 AND session_kind "
        "= ?2 AND phase = 'main' GROUP BY participant_code",
        study, kind);
    while (row.step()) {
        Judgement& one = people.at(row.text(0));
        one.answers = row.integer(1);
        one.invalid = row.integer(2);
        one.main = one.answers - one.invalid;
        one.correct = row.integer(3);
        one.timed_out = row.integer(4);
    }
}

/// The picture that whoever attends chooses for an object that is not pictured.
std::optional<std::string> outermost(const Protocol& protocol, const std::string& felt) {
    const auto object = std::find_if(protocol.objects.begin(), protocol.objects.end(),
                                     [&](const auto& one) { return one.name == felt; });
    if (object == protocol.objects.end() || !curvature_of(*object)) {
        return std::nullopt;
    }
    const double side = *curvature_of(*object) > 0.0 ? 1.0 : -1.0;
    const protocols::ObjectSpec* extreme = nullptr;
    for (const std::size_t i : objects_of(protocol, true)) {
        const protocols::ObjectSpec& picture = protocol.objects[i];
        if (!curvature_of(picture)) {
            return std::nullopt;
        }
        if (extreme == nullptr || side * *curvature_of(picture) > side * *curvature_of(*extreme)) {
            extreme = &picture;
        }
    }
    return extreme == nullptr ? std::nullopt : std::optional(extreme->name);
}

void count_catches(Database& database,
                   std::int64_t study,
                   std::string_view kind,
                   const Protocol& protocol,
                   People& people) {
    Statement row = database.prepare(
        "SELECT participant_code, plan.planned_object, response.chosen_object FROM trial JOIN "
        "response USING (trial_id) JOIN plan USING (session_id, plan_position) JOIN session USING "
        "(session_id) JOIN participant USING (participant_id) WHERE study_id = ?1 AND session_kind "
        "= ?2 AND phase = 'catch' AND invalid_reason IS NULL",
        study, kind);
    while (row.step()) {
        Judgement& one = people.at(row.text(0));
        if (const auto right = outermost(protocol, row.text(1))) {
            ++one.catches;
            one.catches_right += row.text(2) == *right ? 1 : 0;
        }
    }
}

double share_of(std::int64_t some, std::int64_t all) {
    return static_cast<double>(some) / static_cast<double>(all);
}

void at_least(
    Judgement& one, std::string_view rule, std::int64_t some, std::int64_t all, double least) {
    if (all > 0 && share_of(some, all) < least) {
        one.broken.push_back(fmt::format("{}: {} of {} = {:.3g}, below {}", rule, some, all,
                                         share_of(some, all), least));
    }
}

void check_share(
    Judgement& one, std::string_view rule, std::int64_t some, std::int64_t all, double extreme) {
    if (all > 0 && share_of(some, all) > extreme) {
        one.broken.push_back(fmt::format("{}: {} of {} = {:.3g}, above {}", rule, some, all,
                                         share_of(some, all), extreme));
    }
}

void apply(const ExclusionSpec& rules, Judgement& one) {
    at_least(one, "catch_correct_min", one.catches_right, one.catches, rules.catch_correct_min);
    at_least(one, "share_correct_min", one.correct, one.main, rules.share_correct_min);
    check_share(one, "timed_out_share_max", one.timed_out, one.main, rules.timed_out_share_max);
    check_share(one, "invalid_share_max", one.invalid, one.answers, rules.invalid_share_max);
    if (rules.sessions_finished && one.unfinished > 0) {
        one.broken.push_back("sessions_finished: " + counted(one.unfinished, "is not", "are not"));
    }
}

}  // namespace

Exclusions judge(Database& database, std::string_view study, std::string_view kind) {
    Exclusions found;
    for (const Statement& row : database.prepare(
             "SELECT study_id, protocol_toml FROM study WHERE study_name = ?1", study)) {
        Protocol protocol;
        try {
            protocol = protocols::stored_protocol(row.text(1));
        } catch (const protocols::ProtocolError&) {
            continue;  // palpate verify says it
        }
        People people;
        count_answers(database, row.integer(0), kind, people);
        count_catches(database, row.integer(0), kind, protocol, people);
        found.rules = found.rules || protocol.exclusion != ExclusionSpec{};
        for (auto& [code, one] : people) {
            apply(protocol.exclusion, one);
            found.all.push_back(std::move(one));
        }
    }
    std::stable_sort(
        found.all.begin(), found.all.end(),
        [](const Judgement& a, const Judgement& b) { return a.participant < b.participant; });
    return found;
}

}  // namespace palpate::data
