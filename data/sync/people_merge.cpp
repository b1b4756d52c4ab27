#include "data/sync/people_merge.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate::data {
namespace {

constexpr const char* kHandedness = "handedness";
constexpr const char* kConsent = "consent";
constexpr const char* kDestroyedTime = "destroyed_utc";
constexpr const char* kSubject = "subject";
constexpr std::string_view kDetail = "detail ";

}  // namespace

void PeopleMerge::say(const std::string& code, const std::string& key, const NotedDetail& said) {
    Person& person = people_[code];
    const auto [at, is_new] = person.emplace(key, said);
    NotedDetail& there = at->second;
    if (is_new) {
        return;
    }
    if (key == kSubject) {  // a number drawn twice: the lesser
        there = said.value < there.value ? said : there;
        return;
    }
    if (there.value == said.value || key == kDestroyedTime) {
        there.utc = std::max(there.utc, said.utc);
        return;
    }
    if (there.utc == said.utc && there.file != prefer_ && said.file != prefer_) {
        in_conflict_.insert(code);
        conflicts_.push_back(
            {.what = fmt::format("participant {}: {} is {} and {}, noted at one time", code, key,
                                 there.value, said.value),
             .first = there.file,
             .second = said.file,
             .remedy = kPreferRemedy});
        return;
    }
    const bool newer = there.utc == said.utc ? said.file == prefer_ : there.utc < said.utc;
    const NotedDetail& now = newer ? said : there;
    const NotedDetail& before = newer ? there : said;
    notices_.push_back(
        fmt::format("participant {}: {} is {} (noted {} in {}), no longer {} ({} in {})", code, key,
                    now.value, now.utc, now.file, before.value, before.utc, before.file));
    there = NotedDetail(now);
}

void PeopleMerge::read(Database& database, const std::string& file) {
    Statement row = database.prepare(
        "SELECT participant_code, handedness, coalesce(handedness_utc, ''), consent, "
        "coalesce(consent_utc, ''), printf('%010d', subject), '', iif(destroyed_utc IS NULL, NULL, "
        "'yes'), destroyed_utc FROM participant");
    while (row.step()) {
        const std::string code = row.text(0);
        people_[code];
        int column = 1;
        for (const char* key : {kHandedness, kConsent, kSubject, kDestroyedTime}) {
            if (!row.null(column)) {
                say(code, key, {row.text(column), file, row.text(column + 1)});
            }
            column += 2;
        }
    }
    for (const Statement& detail :
         database.prepare("SELECT participant_code, key, value, noted_utc FROM participant_detail "
                          "JOIN participant USING (participant_id)")) {
        say(detail.text(0), std::string(kDetail) + detail.text(1),
            {detail.text(2), file, detail.text(3)});
    }
}

void PeopleMerge::number() {
    std::map<std::string, std::pair<std::string, std::string>> taken;
    for (const auto& [code, person] : people_) {
        const NotedDetail& said = person.at(kSubject);
        const auto [there, is_new] = taken.emplace(said.value, std::pair(code, said.file));
        if (!is_new) {
            in_conflict_.insert(code);
            conflicts_.push_back(
                {.what = fmt::format("participants {} and {}: both have the number {} in exports",
                                     there->second.first, code, said.value),
                 .first = there->second.second,
                 .second = said.file,
                 .remedy = "one of them has to be registered anew in a file of its own"});
        }
    }
}

/// It was noted since somebody had all destroyed, if they had.
bool PeopleMerge::stays(const Person& person, const std::string& key) {
    const auto said = person.find(key);
    const auto destroyed = person.find(kDestroyedTime);
    return said != person.end() && (destroyed == person.end() || key == kConsent ||
                                    said->second.utc > destroyed->second.utc);
}

/// Handedness, consent and the time of destruction: ?2 to ?6.
void PeopleMerge::bind_notes(const Person& person, Statement& note) {
    int parameter = 2;
    for (const char* key : {kHandedness, kConsent}) {
        const bool known = stays(person, key);
        note.bind(parameter, known ? std::optional(person.at(key).value) : std::nullopt)
            .bind(parameter + 1, known ? std::optional(person.at(key).utc) : std::nullopt);
        parameter += 2;
    }
    const auto destroyed = person.find(kDestroyedTime);
    note.bind(6, destroyed == person.end() ? std::nullopt : std::optional(destroyed->second.utc));
}

void PeopleMerge::write_details(const std::string& code, const Person& person, Statement& detail) {
    for (const auto& [key, said] : person) {
        if (key.starts_with(kDetail) && stays(person, key)) {
            detail.bind(1, std::string_view(code))
                .bind(2, std::string_view(key).substr(kDetail.size()))
                .bind(3, std::string_view(said.value))
                .bind(4, std::string_view(said.utc))
                .run();
        }
    }
}

void PeopleMerge::write(Database& out) const {
    Statement add = out.prepare(
        "INSERT INTO participant (participant_code, subject) VALUES (?1, CAST(?2 AS INTEGER)) ON "
        "CONFLICT (participant_code) DO NOTHING");
    Statement note = out.prepare(
        "UPDATE participant SET handedness = CAST(?2 AS INTEGER), handedness_utc = ?3, consent = "
        "CAST(?4 AS INTEGER), consent_utc = ?5, destroyed_utc = ?6, subject = CAST(?7 AS INTEGER) "
        "WHERE participant_code = ?1");
    Statement gone = out.prepare(
        "DELETE FROM participant_detail WHERE participant_id = (SELECT participant_id FROM "
        "participant WHERE participant_code = ?1)");
    Statement detail = out.prepare(
        "INSERT INTO participant_detail SELECT participant_id, ?2, ?3, ?4 FROM participant WHERE "
        "participant_code = ?1");
    for (const auto& [code, person] : people_) {
        if (in_conflict_.contains(code)) {
            continue;
        }
        const std::string& subject = person.at(kSubject).value;
        add.bind(1, std::string_view(code)).bind(2, std::string_view(subject)).run();
        note.bind(1, std::string_view(code)).bind(7, std::string_view(subject));
        bind_notes(person, note);
        note.run();
        gone.bind(1, std::string_view(code)).run();
        write_details(code, person, detail);
    }
}

}  // namespace palpate::data
