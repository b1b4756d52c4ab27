#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocols/protocol/protocol.hpp"
#include "data/analysis/left_out.hpp"
#include "data/csv/number_table.hpp"
#include "data/store/analysed.hpp"
#include "data/store/database.hpp"

/// Answered trials of several people, as all statistics take them: a database's, or any lab's.
namespace palpate::data {

/// One answered trial.
struct Trial {
    std::size_t subject =
        0;  ///< of TrialTable::subjects; the next three are places in its lists too
    std::int64_t number = 0;  ///< of the subject's, in the order run
    std::size_t shape = 0;    ///< what was felt
    std::size_t friction = 0;
    std::size_t response = 0;            ///< what it was called
    std::optional<double> rt_s{};        ///< question -> answer, s, > 0
    std::optional<double> explore_s{};   ///< first contact -> done, s, > 0
    std::optional<double> confidence{};  ///< the higher the surer
    std::optional<double>
        since_break{};       ///< trials since the begin of the session or the last break
    std::string excluded{};  ///< why it does not count; empty: it counts
};

/// All of them, and what their columns mean.
struct TrialTable {
    std::string source{};
    std::string study{};  ///< of a database; so is the kind: real, pilot, simulated
    std::string kind{};
    std::optional<protocols::PrimaryTest>
        primary{};  ///< of a database's study, as its protocol says
    /// What the primary comparison is of, against the first: the largest of that protocol.
    std::string primary_friction{};
    std::vector<std::string> subjects{};
    std::vector<std::string> shapes{};
    std::vector<std::string> frictions{};  ///< the first is what the others are compared with
    std::vector<std::string> responses{};
    /// How many pictures an answer was one of; 0: of yes and no.
    std::size_t alternatives = 0;
    std::vector<StudyVersion> versions{};  ///< of a database with several of a protocol
    std::optional<LeftOut> left_out{};     ///< of a database
    std::vector<Trial> trials{};           ///< by subject, then by number
};

/// Columns subject,trial,shape,friction,response and, if they are there, rt_s, confidence,
/// explore_s, since_break and excluded (why a trial does not count; empty, 0, NA or False: it
/// does). Numbers that are not known are empty, or NA. Answers of yes and no alone are those of
/// yes/no; else the pictures are the shapes and responses that occur.
/// @param others  answers that name no shape are kept, as pictures of what nobody felt
/// @throws CsvError with file, line and character, value and remedy; so is such an answer without
/// `others`
[[nodiscard]] TrialTable read_trials(const RereadableText& text, bool others = true);

/// The same columns, each trial a row: read_trials() of it gives the table, but for its study and
/// kind.
[[nodiscard]] std::string trials_csv(const TrialTable& table);

/// Answered main trials of identification and yes-no, no rule among them; trials that do not count,
/// and those of people whom the protocol's rules leave out, say why.
/// @throws std::invalid_argument if there are none, or of several studies: which there are
[[nodiscard]] TrialTable stored_trials(Database& database, const AnswerChoice& choice);

/// Makes this friction the first. @throws std::invalid_argument if there is no such friction: which
/// there are
void compare_with(TrialTable& table, const std::string& friction);

}  // namespace palpate::data
