#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/session/progress.hpp"
#include "protocols/session/recorder.hpp"
#include "data/store/database.hpp"

/// What a session knew and knows, folded from its rows (protocols::SessionProgress).
namespace palpate::data {

/// How a session that was broken off goes on.
enum class Resume : std::uint8_t {
    go_on,       ///< with the next trial
    redo_block,  ///< with the first trial of the part of the next one: its practice, or its block
    redo_practice,  ///< with the first practice trial; then with the next of the others
};
inline constexpr std::array<std::string_view, 3> kResumeWords{"continue", "redo-block",
                                                              "redo-practice"};

/// An event, and when in the session it came.
struct StoredEvent {
    std::int64_t trials_begun = 0;  ///< of the session by then
    protocols::Event event;
};
/// The events of a session in their order.
[[nodiscard]] std::vector<StoredEvent> stored_events(Database& database, std::int64_t session);

/// An attempt as its rows say.
struct StoredAttempt {
    protocols::Attempt attempt;  ///< `counts` as when it ended: a mark came later
    std::string state_hash;      ///< of the rule that took the answer in
};
/// The attempts of a session in their order. One that runs is given as interrupted.
[[nodiscard]] std::vector<StoredAttempt> stored_attempts(Database& database, std::int64_t session);

/// What the session knows by all of its rows. @param begun  before the first trial
/// @throws StoreError if a stored stimulus or state is not what the rule gives: nothing may run
/// then
[[nodiscard]] protocols::SessionProgress stored_progress(Database& database,
                                                         std::int64_t session,
                                                         protocols::SessionProgress begun);

/// Begins a part again: an event says so, and every answer in it that counts is marked with the
/// reason, and stays. Nothing happens where nothing was answered.
/// @return what the session knows then
[[nodiscard]] protocols::SessionProgress begin_again(Database& database,
                                                     std::int64_t session,
                                                     Resume how,
                                                     protocols::SessionProgress progress);

// -------------------------------------------------------------------------------------------------
// Rules that choose stimuli: what is stored of them, and how they are built again.

/// {"threshold":{"mean":5.1,"mode":5},...} as adaptive_step.estimates has it; numbers as short as
/// can be.
[[nodiscard]] std::string estimates_text(const std::vector<protocols::Estimate>& estimates);

/// The rules of a session by the answers that count at the end, stored states unchecked: what is
/// stored beside an answer took in those that were marked after it.
/// @throws std::exception if the session, its protocol or an answer is not what a rule takes
[[nodiscard]] protocols::AdaptiveRuns runs_that_count(Database& database, std::int64_t session);

/// A run of a session as palpate procedure reads it.
struct ExportedRun {
    std::string
        procedure;  ///< a procedure file: the protocol's rule, and where the run's stream begins
    std::string responses;  ///< CSV: stimulus,response, in the order of the answers
};

/// Answers that were marked later are left out: what is replayed is the rule as it stands at the
/// end.
/// @param run  from 0
/// @throws StoreError if there is no such session or run
[[nodiscard]] ExportedRun exported_run(Database& database, std::int64_t session, std::int64_t run);

/// Keys of provenance that a device's calibration has: its canonical text, and the hash of that.
inline constexpr std::string_view kCalibrationKey = "calibration";
inline constexpr std::string_view kCalibrationHashKey = "calibration sha256";

/// On what a trial is felt.
struct TrialDevice {
    std::string name;         ///< as the device calls itself
    std::string calibration;  ///< SHA-256 of its canonical text; empty: it has none

    /// Nothing of what the scene renders reaches a hand at a pointer.
    [[nodiscard]] bool gives_force() const noexcept { return name != "mouse"; }
};

/// Of the last trial; none: there is no trial.
[[nodiscard]] std::optional<TrialDevice> last_device(Database& database, std::int64_t session);

/// What the board said of itself as the last trial began (protocols::kBoard); empty: it says
/// nothing, or there is no trial.
[[nodiscard]] std::string last_board(Database& database, std::int64_t session);

/// Whatever the port is called at which it is plugged in today.
[[nodiscard]] bool same_rig(const TrialDevice& a, const TrialDevice& b);

/// The fold: a session that is planned again, before its first trial, begins anew.
struct DeviceProgress {
    TrialDevice begun;
    TrialDevice now = begun;
};
/// The device after the next event; only those that change it do.
[[nodiscard]] DeviceProgress apply(DeviceProgress device, const protocols::Event& event);
/// Before any event.
[[nodiscard]] DeviceProgress first_device(Database& database, std::int64_t session);
/// Of the next trial.
[[nodiscard]] TrialDevice next_device(Database& database, std::int64_t session);

/// What shapes a session besides its protocol, by key.
using Provenance = std::map<std::string, std::string>;
/// Before any event.
[[nodiscard]] Provenance first_provenance(Database& database, std::int64_t session);
/// Of the next trial: the last word of each key, without those that ended with an empty one. What a
/// proof found is of its moment alone, and no part of it.
/// @param trials  as it was when so many had begun
[[nodiscard]] Provenance next_provenance(
    Database& database,
    std::int64_t session,
    std::int64_t trials = std::numeric_limits<std::int64_t>::max());

/// "mouse", "Haply on /dev/ttyACM0 (calibration 1a2b3c4d)"
[[nodiscard]] std::string device_text(const TrialDevice& device);

}  // namespace palpate::data
