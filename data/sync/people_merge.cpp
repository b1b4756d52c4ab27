#include <algorithm>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "data/sync/merge.hpp"

namespace palpate::data {

constexpr const char* kHandedness = "handedness";
constexpr const char* kConsent = "consent";
constexpr const char* kSubject = "subject";
constexpr std::string_view kDetail = "detail ";

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
    if (there.value == said.value) {
        return;
    }
    if (there.utc == said.utc && there.file != prefer_) {
        in_conflict_.insert(code);
        conflicts_.push_back(
            {.what = fmt::format("participant {}: {} is {} and {}, noted at one time", code, key,
                                 there.value, said.value),
             .first = there.file,
             .second = said.file,
             .remedy = kPreferRemedy});
        return;
    }
    notices_.push_back(
        fmt::format("participant {}: {} is {} (noted {} in {}), no longer {} ({} in {})", code, key,
                    there.value, there.utc, there.file, said.value, said.utc, said.file));
}

void PeopleMerge::read(Database& database, const std::string& file) {
    Statement row = database.prepare(
        "SELECT participant_code, handedness, coalesce(handedness_utc, ''), consent, "
        "coalesce(consent_utc, ''), printf('%010d', subject), '', coalesce(destroyed_utc, ''), "
        "coalesce(refusals_utc, '') FROM participant");
    while (row.step()) {
        const std::string code = row.text(0);
        int column = 1;
        for (const std::string key : {kHandedness, kConsent, kSubject}) {
            const NotedDetail said{row.text(column), file, row.text(column + 1)};
            if (!row.null(column) && key == kConsent) {
                (said.value == "0" ? refused_ : given_)[code].push_back(said);
            } else if (!row.null(column)) {
                words_.push_back({code, key, said});
            }
            column += 2;
        }
        if (!row.text(7).empty()) {
            destroyed_[code] = std::max(destroyed_[code], row.text(7));
            knows_.insert({file, code, row.text(7)});
        }
        std::istringstream refusals(row.text(8));
        for (std::string utc; refusals >> utc;) {
            refusals_[code].insert(utc);
            knows_.insert({file, code, utc});
        }
    }
    for (const Statement& detail :
         database.prepare("SELECT participant_code, key, value, noted_utc FROM participant_detail "
                          "JOIN participant USING (participant_id)")) {
        words_.push_back({detail.text(0),
                          std::string(kDetail) + detail.text(1),
                          {detail.text(2), file, detail.text(3)}});
    }
}

std::string PeopleMerge::destroyed_unknown_to(const std::string& file,
                                              const std::string& code,
                                              const std::string& noted) const {
    const auto there = destroyed_.find(code);
    if (there == destroyed_.end() || knows_.contains({file, code, there->second})) {
        return "";
    }
    const bool since = file == prefer_ && !of_before_.contains({file, code}) &&
                       (noted.empty() || noted > there->second);
    return since ? "" : there->second;
}

/// By time, so that the order of the files decides nothing.
void PeopleMerge::settle() {
    std::ranges::stable_sort(words_, std::ranges::greater(), [&](const Word& word) {
        return std::pair(word.said.utc, word.said.file == prefer_);
    });
    for (const Word& word : words_) {
        const auto& [code, key, said] = word;
        const std::string destroyed = destroyed_unknown_to(said.file, code, said.utc);
        if (key == kSubject || destroyed.empty()) {
            say(code, key, said);
        } else if (!in_conflict_.contains(code) && forgot_.insert({said.file, code}).second) {
            notices_.push_back(
                fmt::format("participant {}: what {} has noted of them is left out: it was "
                            "destroyed ({}), of which that file does not know",
                            code, said.file, destroyed));
        }
    }
    for (const auto& each : people_) {
        settle_consent(each.first);
    }
    number();
}

/// A refusal stands unless a file that has it says yes now: only there the yes came after it,
/// whatever the clocks of two rigs say.
void PeopleMerge::settle_consent(const std::string& code) {
    std::vector<NotedDetail>& given = given_[code];
    std::vector<NotedDetail>& refused = refused_[code];
    std::ranges::stable_sort(given, std::ranges::greater(), &NotedDetail::utc);
    std::ranges::stable_sort(refused, std::ranges::greater(), &NotedDetail::utc);
    const auto stands = std::ranges::find_if(refused, [&](const NotedDetail& no) {
        return std::ranges::none_of(given, [&](const NotedDetail& yes) {
            return knows_.contains({yes.file, code, no.utc});
        });
    });
    const bool no = stands != refused.end();
    if (no || !given.empty()) {
        people_[code].emplace(kConsent, no ? *stands : given.front());
    }
    if (!refused.empty() && !given.empty()) {
        const NotedDetail& now = no ? *stands : given.front();
        const NotedDetail& before = no ? given.front() : refused.front();
        notices_.push_back(fmt::format(
            "participant {}: consent is {} (noted {} in {}), not {} ({} in {}){}", code,
            no ? "no" : "yes", now.utc, now.file, no ? "yes" : "no", before.utc, before.file,
            no ? ": who consents again after all says so in the former file" : ""));
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

void PeopleMerge::write(Database& out) const {
    for (const auto& [code, person] : people_) {
        if (in_conflict_.contains(code)) {
            continue;
        }
        const auto said = [&person](const char* key) {
            const auto there = person.find(key);
            using Words = std::pair<std::optional<std::string>, std::optional<std::string>>;
            return there == person.end() ? Words() : Words(there->second.value, there->second.utc);
        };
        const auto handedness = said(kHandedness);
        const auto consent = said(kConsent);
        const auto destroyed = destroyed_.find(code);
        const auto refusals = refusals_.find(code);
        out.run(
            "INSERT INTO participant (participant_code, subject) VALUES (?1, CAST(?2 AS INTEGER)) "
            "ON CONFLICT (participant_code) DO NOTHING",
            code, person.at(kSubject).value);
        out.run(
            "UPDATE participant SET handedness = CAST(?2 AS INTEGER), handedness_utc = ?3, consent "
            "= CAST(?4 AS INTEGER), consent_utc = ?5, destroyed_utc = ?6, refusals_utc = ?7, "
            "subject = CAST(?8 AS INTEGER) WHERE participant_code = ?1",
            code, handedness.first, handedness.second, consent.first, consent.second,
            destroyed == destroyed_.end() ? std::nullopt : std::optional(destroyed->second),
            refusals == refusals_.end()
                ? std::nullopt
                : std::optional(fmt::format("{}", fmt::join(refusals->second, " "))),
            person.at(kSubject).value);
        out.run(
            "DELETE FROM participant_detail WHERE participant_id = (SELECT participant_id FROM "
            "participant WHERE participant_code = ?1)",
            code);
        for (const auto& [key, noted] : person) {
            if (key.starts_with(kDetail)) {
                out.run(
                    "INSERT INTO participant_detail SELECT participant_id, ?2, ?3, ?4 FROM "
                    "participant WHERE participant_code = ?1",
                    code, key.substr(kDetail.size()), noted.value, noted.utc);
            }
        }
    }
}

}  // namespace palpate::data
