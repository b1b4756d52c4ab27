#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// What is exported, and how much is said of people.
struct ExportOptions {
    std::string kind = "real";  ///< real, pilot, simulated or all
    /// Operator, wall clock, days, notes, handedness score, participant_detail, provenance.
    bool details = false;
    bool traces = false;      ///< every servo tick as well
    bool keep_codes = false;  ///< a table subject -> the code of the lab
};

/// One session that is exported.
struct ChosenSession {
    std::int64_t id = 0;
    std::string subject;  ///< sub-0123456789, for ever
    std::string label;    ///< of the study: letters and digits, no two studies the same
    std::string study;    ///< its name
    std::string title;
    std::int64_t number = 0;  ///< of the participant's chosen sessions of the study
    double rate_hz = 0.0;
};

/// The sessions asked for, in the temporary tables `chosen (session, subject, label, day, number)`
/// and `numbered (trial, number, zero_ns)` and `happened (event, since_ns)` of this connection; one
/// moment of the file.
///
/// A participant is called by the number that was drawn for them when they were registered, and
/// keeps it in every export; rows come in the order of these numbers. Who noted that a participant
/// does not consent (consent 0) has them left out. Orders follow from the file's secret
/// (data/store/secret.hpp): who knows protocol, seed and a list of codes cannot say whose they are.
/// Two exports of a file that grew do say who joined in between.
class Selection {
public:
    /// @throws std::invalid_argument if there is no such session
    Selection(Database& database, const ExportOptions& options);
    [[nodiscard]] const std::vector<ChosenSession>& sessions() const { return sessions_; }
    /// The studies' titles, each once: "One; Another".
    [[nodiscard]] std::string titles() const;

private:
    void choose(const std::string& kind);
    void number_sessions();
    void name_subjects();

    Database& database_;
    Snapshot now_;
    std::vector<ChosenSession> sessions_;
};

/// What every format is given: whose tables, how much of them, and a folder, there and empty.
struct Exporting {
    Database& database;
    const Selection& selection;
    const ExportOptions& options;
    std::filesystem::path folder;
};

}  // namespace palpate::data
