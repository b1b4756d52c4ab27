#include "ui/session/felt_hands.hpp"

#include <stdexcept>

#include "engine/base/refuse.hpp"
#include "engine/base/side_by_side.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/session/session.hpp"
#include "ui/rig/interrupt.hpp"

namespace palpate::ui {
namespace {

using namespace protocols;

/// Feels as long as its hand does, and answers anything.
class FeelingOnly : public Observer {
public:
    FeelingOnly(const OutlineSpec& outline, Apparatus& apparatus)
        : outline_(outline), apparatus_(apparatus), cues_(outline) {}

    [[nodiscard]] Signal welcome(const SessionView& /*session*/) override { return Signal::go_on; }
    [[nodiscard]] Signal ready(const TrialView& /*trial*/) override {
        cues_ = CurvatureCues(outline_);
        return Signal::go_on;
    }
    [[nodiscard]] ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        const bool done = elapsed_s >= trial.explore_min_s && apparatus_.hand_is_done();
        return {.signal = done ? Signal::done : Signal::go_on, .at_s = elapsed_s};
    }
    void feel(std::span<const engine::TickRecord> ticks) override { cues_.add(ticks); }
    [[nodiscard]] Choice choose(const TrialView& /*trial*/, const Question& question) override {
        Choice choice;
        choice.confidence = question.confidence ? std::optional(1) : std::nullopt;
        return choice;
    }
    [[nodiscard]] Signal gap(double /*seconds*/) override { return Signal::go_on; }
    [[nodiscard]] Signal rest(double /*seconds*/, const TrialView& /*next*/) override {
        return Signal::go_on;
    }
    void finish(const SessionView& /*session*/) override {}

    [[nodiscard]] Cues cues() const noexcept { return cues_.cues(); }

private:
    OutlineSpec outline_;
    Apparatus& apparatus_;
    CurvatureCues cues_;
};

class NoRecorder : public Recorder {
public:
    [[nodiscard]] TrialId begin_trial(const PlannedTrial& /*planned*/) override {
        return ++trials_;
    }
    void begin_interval(TrialId /*trial*/,
                        const Presentation& /*felt*/,
                        const SceneConstants& /*scene*/) override {}
    void append(TrialId /*trial*/, std::span<const engine::TickRecord> /*ticks*/) override {}
    void end_trial(TrialId /*trial*/, const TrialResult& /*result*/) override {}
    void event(const Event& /*event*/) override {}
    void finish_session() override {}

private:
    TrialId trials_ = 0;
};

std::vector<FeltTrial> felt_by(const SimulatedStudy& study, std::size_t index) {
    const Protocol& protocol = study.study.protocol;
    SimulatedSession session(study, index);
    FeelingOnly observer(protocol.outline, session.apparatus());
    NoRecorder recorder;
    std::vector<FeltTrial> felt;
    SessionView view;
    view.simulated = true;
    const SessionEnd end =
        run_session(protocol, session.plan(), view,
                    SessionProgress(protocol, session.plan(),
                                    session_stream(study.study.hash, session.key(), study.seed)),
                    {.apparatus = session.apparatus(),
                     .observer = observer,
                     .recorder = recorder,
                     .interrupted = [] { return interrupted(); },
                     .progress =
                         [&](const Progress& progress) {
                             if (progress.result.response && progress.result.invalid.empty()) {
                                 felt.push_back({.object = progress.planned.condition.object,
                                                 .friction = progress.planned.condition.friction,
                                                 .cues = observer.cues()});
                             }
                         }});
    refuse_if<std::runtime_error>(end.why != SessionEnd::Why::finished, "{}",
                                  end.why == SessionEnd::Why::aborted
                                      ? std::string("it was interrupted: nothing was computed")
                                      : end.fault);
    return felt;
}

}  // namespace

std::vector<FeltTrial> felt_hands(const SimulatedStudy& all,
                                  std::size_t people,
                                  std::size_t threads) {
    SimulatedStudy study = all;
    DesignSpec& design = study.study.protocol.design;
    design.practice_repetitions = 0;
    design.catch_trials = 0;
    design.break_every = 0;
    std::vector<std::vector<FeltTrial>> felt(people);
    for_each_number(threads, people, [&](std::size_t i) { felt[i] = felt_by(study, i); });
    std::vector<FeltTrial> together;
    for (const auto& one : felt) {
        together.insert(together.end(), one.begin(), one.end());
    }
    return together;
}

}  // namespace palpate::ui
