#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/protocol/protocol.hpp"
#include "data/analysis/left_out.hpp"
#include "data/store/analysed.hpp"
#include "data/store/database.hpp"

/// The study that a page is about, and what is asked of its file.
namespace palpate::data {

/// What a page is made of, and how.
struct PageOptions {
    std::string kind = "real";           ///< real, pilot or simulated: never two of them
    std::string study{};                 ///< needed where the file has several of that kind
    bool codes = false;                  ///< people by the lab's codes, not by numbers of this page
    std::vector<std::string> signals{};  ///< of yes/no: the shapes for which yes is right
    std::size_t simulations =
        199;  ///< of the mixed model without an effect: StatsOptions::simulations
    std::size_t bootstrap = 500;  ///< of psychometric functions: FitOptions::bootstrap
    std::string version{};        ///< of the program that makes the page
};

/// A query of queries.sql, as it stands there. @throws std::logic_error if there is none
[[nodiscard]] std::string_view page_query(std::string_view name);

/// Each `from` of a text as `to`.
[[nodiscard]] std::string replaced(std::string text, std::string_view from, std::string_view to);

/// The rows of a query, to the byte as `palpate sql FILE --csv -c SQL` prints them.
struct Rows {
    std::string sql{};
    std::string csv{};
    std::vector<std::string> names{};
    std::vector<std::vector<std::string>> cells{};  ///< row by row; empty: NULL

    /// @throws std::logic_error for a column that is not there
    [[nodiscard]] const std::string& text(std::size_t row, std::string_view name) const;
    /// NaN for NULL and for what is no number.
    [[nodiscard]] double number(std::size_t row, std::string_view name) const;
    /// All of a column, times a factor; their sum without NaN.
    [[nodiscard]] std::vector<double> numbers(std::string_view name, double factor = 1.0) const;
    [[nodiscard]] double sum(std::string_view name) const;
    /// The rows with this text in a column; without `sql` and `csv`.
    [[nodiscard]] Rows where(std::string_view name, std::string_view level) const;
    /// Different texts of a column, in the order of the rows.
    [[nodiscard]] std::vector<std::string> levels(std::string_view name) const;
};

/// Who and what a page is about, as a file has it.
class Study {
public:
    /// @throws std::invalid_argument if the file has no such session, or several studies: which
    /// there are
    Study(Database& database, const PageOptions& options);

    /// The rows of a query that may read, beside tables and views,
    ///
    ///     person  a row a person with a session of the study and kind: person (a number, or the
    ///             code where codes are asked for), subject (of exports), left_out (1: by the
    ///             protocol's rules)
    ///     main    analysis_trial of their main trials, with person and left_out
    ///
    /// @param sql  begins with SELECT or WITH; {study}, {kind} stand for their names in quotes,
    ///             {hit} for whether an answer is right (of yes/no without signals: yes), {right}
    ///             for the same or NULL where nothing is, {signal} for whether yes is right
    /// @throws StoreError if the file says no
    [[nodiscard]] Rows ask(std::string_view sql) const;

    /// "3", or the code; of a code, and of a number in exports, either.
    [[nodiscard]] std::string person(const std::string& known_as) const;
    /// Everybody with an answer that counts is left out by rule.
    [[nodiscard]] bool nobody_left() const {
        return left_out.by_rule.people > 0 && left_out.analysed.people == 0;
    }

    PageOptions options;
    std::string name;  ///< the study's id
    std::string title;
    protocols::Protocol protocol;  ///< as its newest version says
    std::size_t people = 0;
    LeftOut left_out;  ///< people as on the page
    /// " --kind simulated --study x": what other commands need to speak of the same.
    std::string words;
    /// Of which protocols the file has several, and " --versions apart": how they are taken; else
    /// nothing.
    std::vector<StudyVersion> versions;
    std::string seen;
    /// FILE, since a name may hold a code; where codes are asked for, the file's without its
    /// folder.
    std::string file;

private:
    void choose();
    void number_people();

    Database* database_;
    std::map<std::string, std::string> person_;
    std::string person_sql_;
    std::string main_sql_;
};

// -------------------------------------------------------------------------------------------------
// Pages of HTML that stand alone: no file beside them, nothing asked of a network. A study's has
// no script; a trial's has one, which draws every tick, and without scripts and on paper drawings
// stand there instead.

/// Flow and exclusions, confusions, the effect of friction within person, ratings, psychometric
/// functions and their tracks, times, confidence, learning, exploration, the audit, health of the
/// rig, seals, methods; beside every figure its table, CSV and SQL. Numbers are those of
/// stats_of(), audit_of() and fit_all(). People are numbered from 1 in the order of their numbers
/// in exports, which follows from the file's secret. No day is named. The same file gives the same
/// bytes.
/// @throws std::invalid_argument if there is no such session, or several studies: which there are
[[nodiscard]] std::string study_page(Database& database, const PageOptions& options);

/// Which trial, and how its person is called.
struct TrialPageOptions {
    std::int64_t trial = 0;  ///< trial.trial_id
    bool codes =
        false;  ///< the person by the lab's code, not by the number that study_page() gives
    std::string version{};  ///< of the program that makes the page
};

/// Who and what, of each interval what the hand did (all columns of the view `exploration`), its
/// path on the object, and every tick: place, rendered force, speed, mode and lateness, in uPlot,
/// to zoom into. Beside every figure its table, CSV and SQL. No day is named. The same file gives
/// the same bytes.
/// @throws std::invalid_argument if there is no such trial, or its person does not consent
/// @throws TraceError if a chunk is damaged or the replay gives other numbers than the servo had
[[nodiscard]] std::string trial_page(Database& database, const TrialPageOptions& options);

}  // namespace palpate::data
