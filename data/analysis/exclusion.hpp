#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// One participant of a study, and which of the protocol's rules of exclusion they break.
///
/// Answers that do not count are only in `answers` and `invalid`. A catch trial is answered rightly
/// with the outermost picture on its side: the most convex one for an object of curvature > 0, the
/// most concave one below 0. Where there is nothing to judge (no catch trial was answered) a rule
/// is not broken.
struct Judgement {
    std::string participant;
    std::int64_t main = 0;              ///< main trials with an answer that counts
    std::int64_t correct = 0;           ///< of these
    std::int64_t timed_out = 0;         ///< of these
    std::int64_t answers = 0;           ///< in main trials, that count or not
    std::int64_t invalid = 0;           ///< of these
    std::int64_t catches = 0;           ///< catch trials with an answer that counts
    std::int64_t catches_right = 0;     ///< of these
    std::int64_t unfinished = 0;        ///< sessions begun and not finished
    std::vector<std::string> broken{};  ///< "catch_correct_min: 1 of 4 = 0.25, below 0.75"
};

struct Exclusions {
    bool rules = false;  ///< the protocol has some
    /// by pseudonym, and by protocol where a study has had several versions
    std::vector<Judgement> all;
};

/// Judges everybody who has a session of this kind, by the rules of the protocol that they ran. Who
/// ran several versions of a study is judged by each, with the sessions of each.
/// @param study  the protocol's id
/// @param kind   "real", "pilot" or "simulated"
[[nodiscard]] Exclusions judge(Database& database, std::string_view study, std::string_view kind);

}  // namespace palpate::data
