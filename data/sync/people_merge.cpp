#include "data/sync/people_merge.hpp"

#include <fmt/format.h>

namespace palpate::data {
namespace {

constexpr const char* kHandedness = "handedness";
constexpr const char* kConsent = "consent";
constexpr const char* kConsentTime = "consent_utc";
constexpr const char* kSubject = "subject";
constexpr std::string_view kDetail = "detail ";

}  // namespace

void PeopleMerge::say(const std::string& code, const std::string& key, const Said& said) {
    Person& person = people_[code];
    const auto [there, is_new] = person.emplace(key, said);
    if (is_new || there->second.value == said.value) {
        return;
    }
    // The same answer noted twice: when it was noted first. A number drawn twice: the lesser.
    if (key == kConsentTime || key == kSubject) {
        if (said.value < there->second.value) {
            there->second = said;
        }
        return;
    }
    in_conflict_.insert(code);
    conflicts_.push_back({.what = fmt::format("participant {}: {} is {} and {}", code, key,
                                              there->second.value, said.value),
                          .first = there->second.file,
                          .second = said.file});
}

void PeopleMerge::read(Database& database, const std::string& file) {
    Statement row = database.prepare(
        "SELECT participant_code, handedness, consent, consent_utc, printf('%010d', subject) FROM "
        "participant");
    while (row.step()) {
        const std::string code = row.text(0);
        people_[code];
        int column = 0;
        for (const char* key : {kHandedness, kConsent, kConsentTime, kSubject}) {
            if (!row.null(++column)) {
                say(code, key, {row.text(column), file});
            }
        }
    }
    Statement detail = database.prepare(
        "SELECT participant_code, key, value FROM participant_detail JOIN participant USING "
        "(participant_id)");
    while (detail.step()) {
        say(detail.text(0), std::string(kDetail) + detail.text(1), {detail.text(2), file});
    }
}

void PeopleMerge::number() {
    std::map<std::string, std::pair<std::string, std::string>> taken;
    for (const auto& [code, person] : people_) {
        const Said& said = person.at(kSubject);
        const auto [there, is_new] = taken.emplace(said.value, std::pair(code, said.file));
        if (!is_new) {
            in_conflict_.insert(code);
            conflicts_.push_back(
                {.what = fmt::format("participants {} and {}: both have the number "
                                     "{} in exports",
                                     there->second.first, code, said.value),
                 .first = there->second.second,
                 .second = said.file});
        }
    }
}

void PeopleMerge::write(Database& out) const {
    Statement add = out.prepare(
        "INSERT INTO participant (participant_code, subject) VALUES (?1, CAST(?2 AS INTEGER)) ON "
        "CONFLICT (participant_code) DO NOTHING");
    Statement note = out.prepare(
        "UPDATE participant SET handedness = CAST(?2 AS INTEGER), consent = CAST(?3 AS INTEGER), "
        "consent_utc = ?4, subject = CAST(?5 AS INTEGER) WHERE participant_code = ?1");
    Statement detail = out.prepare(
        "INSERT INTO participant_detail SELECT participant_id, ?2, ?3 FROM participant WHERE "
        "participant_code = ?1 ON CONFLICT (participant_id, key) DO NOTHING");
    for (const auto& [code, person] : people_) {
        if (in_conflict_.contains(code)) {
            continue;
        }
        add.bind(1, std::string_view(code))
            .bind(2, std::string_view(person.at(kSubject).value))
            .run();
        note.bind(1, std::string_view(code));
        int parameter = 1;
        for (const char* key : {kHandedness, kConsent, kConsentTime, kSubject}) {
            const auto said = person.find(key);
            ++parameter;
            said == person.end() ? note.bind_null(parameter)
                                 : note.bind(parameter, std::string_view(said->second.value));
        }
        note.run();
        for (const auto& [key, said] : person) {
            if (key.starts_with(kDetail)) {
                detail.bind(1, std::string_view(code))
                    .bind(2, std::string_view(key).substr(kDetail.size()))
                    .bind(3, std::string_view(said.value))
                    .run();
            }
        }
    }
}

}  // namespace palpate::data
