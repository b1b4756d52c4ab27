#pragma once

#include <string>
#include <vector>

#include "data/analysis/left_out.hpp"
#include "data/fit/fit_report.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

/// There is no graded stimulus to fit, but there are answers by a picture's name.
[[nodiscard]] bool answers_are_names(Database& database, const AnswerChoice& choice);

/// What a database has to fit.
struct StoredAnswers {
    std::string study{};
    std::vector<Answers> all{};
    /// Runs in the order of the protocol, frictions from the least: as in all tables.
    std::vector<std::string> conditions{};
    std::string stimulus{};                ///< what it is: "curvature in 1/m"
    std::vector<StudyVersion> versions{};  ///< where the file has several of a protocol
    LeftOut left_out{};
};

/// Of every participant and condition of a study the answers that count, main trials alone. Where a
/// rule chose the levels: the runs, by name, its stimulus, and how often the answer was 1 (two
/// intervals: the comparison); with yes-no on planned objects: their curvature in 1/m, by friction,
/// and how often yes. Sessions of a participant add up; what the rules believe stands beside them,
/// session by session. Without whom the protocol's rules leave out.
/// @throws std::invalid_argument if there are none, or of several studies: which there are; if
/// versions that are taken together do not have stimuli of one kind
[[nodiscard]] StoredAnswers stored_answers(Database& database, const AnswerChoice& choice);

}  // namespace palpate::data
