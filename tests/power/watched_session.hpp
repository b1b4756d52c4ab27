#pragma once

#include "data/store/async_recorder.hpp"
#include "tests/support/adaptive.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/disk_model.hpp"

/// Sessions on a watched disk: what they promised, and what is in their files.
namespace palpate::tests {

/// What the recorder has said to be on the disk.
struct Promise {
    std::size_t calls = 0;         ///< of the disk so far, when it said so
    protocols::TrialId trial = 0;  ///< of the running trial; 0: none has begun
    std::int64_t interval = 1;
    std::int64_t ticks = 0;    ///< of the interval
    std::size_t answered = 0;  ///< trials
    bool finished = false;
};

/// Saves often, and notes what was promised at which moment of the disk.
class Noting : public protocols::Recorder {
public:
    /// @param promises    where to: begins with what was promised before
    /// @param save_every  of a writing thread between this and the recorder; nothing: there is none
    Noting(protocols::Recorder& recorder,
           const WatchedDisk& disk,
           std::vector<Promise>& promises,
           std::optional<std::chrono::milliseconds> save_every)
        : thread_(save_every ? std::make_unique<data::AsyncRecorder>(recorder, *save_every)
                             : nullptr),
          recorder_(thread_ ? *thread_ : recorder),
          disk_(disk),
          promises_(promises),
          now_(promises.back()) {}

    protocols::TrialId begin_trial(const protocols::PlannedTrial& planned) override {
        now_.trial = recorder_.begin_trial(planned);
        now_.interval = 1;
        now_.ticks = 0;
        handed_ = 0;
        note();
        return now_.trial;
    }
    void begin_interval(protocols::TrialId trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) override {
        recorder_.begin_interval(trial, felt, scene);
        now_.interval = static_cast<std::int64_t>(felt.interval);
        now_.ticks = 0;
        handed_ = 0;
        note();
    }
    void append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) override {
        recorder_.append(trial, ticks);
        handed_ += static_cast<std::int64_t>(ticks.size());
        constexpr std::int64_t kSaveEvery = 150;
        if (handed_ - now_.ticks >= kSaveEvery && recorder_.save()) {
            now_.ticks = handed_;
            note();
        }
    }
    void end_trial(protocols::TrialId trial, const protocols::TrialResult& result) override {
        recorder_.end_trial(trial, result);
        now_.answered += result.response ? 1U : 0U;
        now_.ticks = handed_;
        note();
    }
    void event(const protocols::Event& event) override { recorder_.event(event); }
    void finish_session() override {
        recorder_.finish_session();
        now_.finished = true;
        note();
    }

private:
    void note() {
        now_.calls = disk_.calls();
        promises_.push_back(now_);
    }

    std::unique_ptr<data::AsyncRecorder> thread_;
    protocols::Recorder& recorder_;
    const WatchedDisk& disk_;
    std::vector<Promise>& promises_;
    Promise now_;
    std::int64_t handed_ = 0;
};

inline std::string lines(data::Database& database, const char* sql) {
    auto row = database.prepare(sql);
    std::string text;
    while (row.step()) {
        for (int i = 0; i < row.columns(); ++i) {
            text += row.type(i) == 2 ? fmt::format("{} ", row.real(i)) : row.text(i) + ' ';
        }
        text += '\n';
    }
    return text;
}

/// All that was felt and answered, to the bit; not when, and not in how many attempts.
inline std::string content(data::Database& database) {
    return lines(database,
                 "SELECT plan_position, response.chosen_object, chosen_place, correct, reaction_s, "
                 "done_s, path_length_m, energy_j FROM trial JOIN response ON trial.trial_id = "
                 "response.trial_id ORDER BY plan_position") +
           lines(database,
                 "SELECT plan_position, interval, first_tick, trace_chunk.ticks, crc32, derived "
                 "FROM trial JOIN response ON trial.trial_id = response.trial_id JOIN trace_chunk "
                 "ON trial.trial_id = trace_chunk.trial_id ORDER BY plan_position, interval, "
                 "first_tick") +
           lines(database,
                 "SELECT plan_position, stimulus, rule_outcome, estimates, state_sha256 FROM "
                 "analysis_trial WHERE run_trial_number IS NOT NULL ORDER BY plan_position") +
           lines(database, "SELECT finished FROM session");
}

/// What must hold of a file that a power cut or a failing disk left, and, where the session went on
/// from it, of the whole.
inline void check_left(const std::string& file,
                       const data::SessionSpec& spec,
                       const Promise& promised,
                       const std::string& whole,
                       bool goes_on) {
    data::Database database(file, data::Access::write);
    REQUIRE(lines(database, "PRAGMA integrity_check") == "ok \n");
    CHECK(count(database, "response") >= static_cast<std::int64_t>(promised.answered));
    CHECK(count(database, "trial") >= promised.trial);
    CHECK(database
              .first(fmt::format(
                  "SELECT sum(ticks) FROM trace_chunk WHERE trial_id = {} AND interval = {}",
                  promised.trial, promised.interval))
              .integer(0) >= promised.ticks);
    CHECK((!promised.finished || database.first("SELECT finished FROM session").integer(0) == 1));
    CHECK(differences(database) == "");
    const std::size_t running =
        static_cast<std::size_t>(count(database, "trial WHERE outcome = 'running'"));
    CHECK(data::open_session(database, spec).interrupted == running);
    if (goes_on && !promised.finished) {
        CHECK(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
        CHECK(differences(database) == "");
    }
    if (goes_on) {
        CHECK(content(database) == whole);
    }
}

inline data::SessionSpec short_session(bool adaptive) {
    protocols::Protocol protocol = adaptive ? adaptive_protocol() : small_protocol();
    protocol.timing.explore_min = 0.1;
    protocol.timing.explore_prompt = 0.3;
    protocol.timing.explore_timeout = 0.4;
    protocol.invalid = {.late_share = 1.0, .contact_min = 0.0, .path_min = 0.0};
    if (adaptive) {
        protocol.procedure->practice_trials = 1;
        protocol.runs.resize(1);
    } else {
        protocol.frictions.resize(1);
    }
    return session_spec(protocol);
}

}  // namespace palpate::tests
