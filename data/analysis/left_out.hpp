#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/csv/json_text.hpp"
#include "data/store/analysed.hpp"
#include "data/store/database.hpp"

/// Whom and what the numbers of a study are without, and why: one account, which every command
/// gives.
namespace palpate::data {

/// Which answers of a file are meant.
struct AnswerChoice {
    std::string kind = "real";  ///< real, pilot or simulated: never two of them
    std::string study{};        ///< needed where the file has several with such answers
    bool codes = false;         ///< people by the lab's codes, not by their numbers in exports
};

/// Of one study and kind. Each person is counted in one place, and so is each answer of a main
/// trial: in the first that holds of no_consent, withdrawn, marked, invalid, by_rule, analysed.
struct LeftOut {
    struct Count {
        std::int64_t people = 0;
        std::int64_t answers = 0;
    };
    struct Reason {
        std::string person;
        std::string why;
    };
    std::string study;
    std::string kind;
    Count in_file{};             ///< people with a session of the study and kind
    Count no_consent{};          ///< of who is noted as not consenting
    Count withdrawn{};           ///< people all of whose sessions were
    std::int64_t marked = 0;     ///< answers that somebody marked
    std::int64_t invalid = 0;    ///< answers that the protocol's rules for a trial refuse
    std::int64_t no_answer = 0;  ///< people without an answer that counts
    Count by_rule{};             ///< the rules of [exclusion]
    Count analysed{};            ///< what is left
    bool rules = false;          ///< the protocol has some of [exclusion]
    /// Whom such a rule leaves out, a row a rule: "catch_correct_min: 1 of 4 = 0.25, below 0.75".
    /// Everybody is judged by the protocol that they ran; who ran several versions of a study by
    /// each, with the sessions of each. Answers that do not count are only in invalid_share_max. A
    /// catch trial is answered rightly with the outermost picture on its side: the most convex one
    /// for an object of curvature > 0, the most concave one below 0. Where there is nothing to
    /// judge (no catch trial was answered, no answer is right or wrong) a rule is not broken.
    std::vector<Reason> broken{};
    std::vector<Reason> withdrawals{};  ///< "P1 session 2", why
    std::vector<StudyVersion>
        elsewhere{};  ///< other kinds, versions and studies: in none of these numbers

    [[nodiscard]] bool leaves_out(std::string_view person) const;
};

/// Whom the protocol's rules leave out, and why.
[[nodiscard]] inline std::map<std::string, std::string> whys_of(const LeftOut& account) {
    std::map<std::string, std::string> whys;
    for (const auto& [person, rule] : account.broken) {
        std::string& why = whys[person];
        why += (why.empty() ? "" : "; ") + rule;
    }
    return whys;
}

/// @param study  as this connection calls it (analyse())
/// @param codes  people by the lab's codes, not by their numbers in exports
[[nodiscard]] LeftOut left_out_of(Database& database,
                                  std::string_view study,
                                  std::string_view kind,
                                  bool codes);
/// Of every study and kind with a session. @param kind  only these; "all": every kind
[[nodiscard]] std::vector<LeftOut> left_out_everywhere(Database& database,
                                                       std::string_view kind,
                                                       bool codes);

/// For people, lines of two spaces and more; for programs the same numbers.
[[nodiscard]] std::string left_out_text(const LeftOut& account);
/// The same below a sentence that says that nothing is left; empty where there is no account.
[[nodiscard]] std::string below(const std::optional<LeftOut>& account);
[[nodiscard]] Json left_out_json(const LeftOut& account);
[[nodiscard]] Json left_out_json(const std::vector<LeftOut>& accounts);

/// To be handed on: no reason that the lab wrote, and nobody who is in no table.
[[nodiscard]] LeftOut without_words(LeftOut account);
/// Lines as remarks of a script: "# " before each.
[[nodiscard]] std::string remarked(std::string_view text);

/// Versions of protocols that a file has, with how many people; an empty list where there are no
/// several.
[[nodiscard]] Json versions_json(const std::vector<StudyVersion>& versions);

/// Where a study or kind has no answer to analyse: who would have some, or nothing to say.
[[nodiscard]] std::string none_left_text(Database& database,
                                         std::string_view study,
                                         std::string_view kind);
/// " of the study s1", where one was asked for.
[[nodiscard]] std::string of_study(const AnswerChoice& choice);
/// The one study whose answers were found. @param what  was looked for: "to fit"
/// @param instead  what to do where nothing was found: "give another file"
/// @throws std::invalid_argument if there are none, or several: which there are
[[nodiscard]] std::string one_study(Database& database,
                                    const AnswerChoice& choice,
                                    const std::set<std::string>& found,
                                    std::string_view what,
                                    std::string_view instead);

}  // namespace palpate::data
