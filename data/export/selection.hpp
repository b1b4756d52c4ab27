#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// What is exported, and how much is said of people.
struct ExportOptions {
    std::string kind = "real";  ///< real, pilot, simulated or all
    bool details = false;       ///< operator, wall clock, notes, participant_detail, provenance
    bool traces = false;        ///< every servo tick as well
    bool keep_codes = false;    ///< a table subject -> the code of the lab
};

/// One session that is exported.
struct ChosenSession {
    std::int64_t id = 0;
    std::string subject;  ///< sub-001
    std::string label;    ///< of the study: letters and digits, no two studies the same
    std::string study;    ///< its name
    std::string title;
    std::int64_t number = 0;
    double rate_hz = 0.0;
};

/// The sessions asked for, in the temporary tables `chosen (session, subject, label, day)` and
/// `numbered (trial, number)` of this connection; one moment of the file.
///
/// Participants are called sub-001, sub-002, ... in the order of a hash that nobody can compute without the
/// file: the same file gives the same names. Who noted that a participant does not consent (consent 0) has
/// them left out. What the names do not hide: the plan of a session is drawn from the participant's code;
/// somebody who knows protocol, seed and a list of codes can try which of them gives this order.
class Selection {
public:
    /// @throws std::invalid_argument if there is no such session
    Selection(Database& database, const ExportOptions& options);
    [[nodiscard]] const std::vector<ChosenSession>& sessions() const { return sessions_; }
    [[nodiscard]] std::int64_t without_consent() const { return without_consent_; }
    /// The studies' titles, each once: "One; Another".
    [[nodiscard]] std::string titles() const;

private:
    void choose(const std::string& kind);
    void name_subjects();

    Database& database_;
    Snapshot now_;
    std::vector<ChosenSession> sessions_;
    std::int64_t without_consent_ = 0;
};

}  // namespace palpate::data
