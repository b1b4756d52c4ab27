#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/session/ports.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/session/session.hpp"
#include "data/store/database.hpp"

/// What a session says on the operator's terminal. A participant may see it: of people's sessions
/// nothing about the stimulus or the answer.
namespace palpate::ui {

/// "trial 12 of 104", "practice 3 of 10": as the participant's screen numbers it.
[[nodiscard]] std::string number_text(const protocols::TrialNumber& number);

/// Of a faulted trial's line on the console: what happened, what to do. For the experimenter, but a
/// participant may see it: nothing of the stimulus.
///
///     fault: the handle was faster than the limit: move more slowly
[[nodiscard]] std::string fault_text(const protocols::Fault& fault);

/// The same where something has to be mended, and when it is.
///
///     trouble: the board at /dev/ttyACM0 is gone: plug it in again and check its power
[[nodiscard]] std::string trouble_text(const protocols::TroubleView& view);

/// A pause of the experimenter's, and its end.
[[nodiscard]] std::string_view pause_text(bool begins) noexcept;

/// What a mark at the desk came to.
[[nodiscard]] std::string mark_text(const protocols::MarkReply& reply);

/// The lines of a run, one an attempt. Each begins with the attempt's trial_id, by which mark,
/// trace and report name it. What came before this run counts for the number of the attempt alone:
/// the pace, and the trials that the alarm looks at, are of this run.
class OperatorLog {
public:
    /// Trials that the alarm looks back on, and how many of them must not count for it.
    static constexpr std::size_t kLookBack = 6;
    static constexpr std::size_t kAlarm = 3;

    /// @param attempts  so far, by position
    /// @param now_s     on any clock that goes on
    OperatorLog(std::map<std::size_t, std::size_t> attempts, double now_s)
        : attempts_(std::move(attempts)), ended_s_(now_s) {}

    /// What became of an attempt, how many trials are left and for how long; after a trial that
    /// does not count a second line if it is the kAlarm-th of the last kLookBack: why, and what to
    /// do.
    /// @param what  of an answer: whatever may be said of it
    [[nodiscard]] std::string line(const protocols::Progress& progress,
                                   const std::string& what,
                                   double now_s);
    /// What a mark came to; whatever it leaves out counts for the alarm, too.
    [[nodiscard]] std::string marked(const protocols::MarkReply& reply);

    /// Until `left` trials are done at this person's pace; none: not known yet.
    [[nodiscard]] std::optional<double> minutes(std::size_t left) const;
    /// kAlarm of the last kLookBack trials do not count.
    [[nodiscard]] bool alarms() const { return !alarm().empty(); }

private:
    [[nodiscard]] std::string left_text(const protocols::Progress& progress) const;
    [[nodiscard]] std::string alarm() const;

    std::map<std::size_t, std::size_t> attempts_;
    double ended_s_;  ///< when the last of took_s_ did, or this run began
    std::vector<double>
        took_s_{};  ///< from one trial that need not run again to the next, in this run, without
                    ///< pauses and troubles
    struct Ended {
        protocols::TrialId trial = 0;
        std::vector<std::string> advice;  ///< none: it counts
    };
    std::deque<Ended> ended_;  ///< the last attempts
};

/// Without its end, where another sentence goes on.
[[nodiscard]] std::string without_stop(std::string sentence);

/// As a shell takes it for one word.
[[nodiscard]] std::string shell_word(const std::string& word);

/// The command that goes on with a session: the words that it was run with, as a shell takes them,
/// without what would begin something again. The launcher says how it was called itself
/// (PALPATE_WORD).
[[nodiscard]] std::string go_on_command(const std::vector<std::string>& words);

/// What the attempts of a run came to: answered, not counting, faulted, minutes, late ticks.
/// @param after  the last trial of the session before this run; 0: none
[[nodiscard]] std::string run_summary(data::Database& database,
                                      std::int64_t session,
                                      std::int64_t after,
                                      double minutes);

}  // namespace palpate::ui
