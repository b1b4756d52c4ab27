#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/safety/trip.hpp"
#include "protocols/trial/observer.hpp"
#include "protocols/trial/start_gate.hpp"
#include "ui/subject/answer_row.hpp"
#include "ui/subject/faces.hpp"
#include "ui/subject/picking.hpp"
#include "ui/subject/stage.hpp"

namespace palpate::ui {

/// The same of a person's screen, and how trials begin and end there.
struct SubjectScreenOptions : StageOptions {
    /// The pointer is the handle: called with every position of it, object frame, m. Empty: it is
    /// not.
    std::function<void(const engine::Vec2&)> on_pointer{};
    /// Where the handle is between trials. Empty, or nowhere: it has no way to a start.
    std::function<std::optional<engine::Vec3>()> place{};
    protocols::StartGate gate{};  ///< where a trial may begin; a pointer is put to its start
    /// The participant holds Space while feeling, and Enter is done: protocol.safety.dead_man.
    bool dead_man = false;
    double guard_s = 0.25;  ///< what is pressed earlier after a screen appeared is no answer to it
    protocols::ResponseKind asks = protocols::ResponseKind::identification;
    /// The dead-man key went down or up. true comes before the trial begins, on_hold(false) at
    /// latest with the first explore() after the key was let go.
    std::function<void(bool)> on_hold{};
};

/// A person at the subject's screen. Times are of CLOCK_MONOTONIC, taken when a press is seen; how
/// late that may be is stored with each.
class SubjectScreen : public protocols::Observer {
public:
    /// Opens the window. @throws as Window
    explicit SubjectScreen(SubjectScreenOptions options);

    [[nodiscard]] protocols::Signal welcome(const protocols::SessionView& session) override;
    [[nodiscard]] protocols::Signal ready(const protocols::TrialView& trial) override;
    [[nodiscard]] protocols::ExplorationStep explore(const protocols::TrialView& trial,
                                                     double elapsed_s) override;
    [[nodiscard]] protocols::Choice choose(const protocols::TrialView& trial,
                                           const protocols::Question& question) override;
    [[nodiscard]] protocols::Signal feedback(const protocols::TrialView& trial,
                                             bool correct) override;
    [[nodiscard]] protocols::Signal gap(double seconds) override;
    [[nodiscard]] protocols::Signal rest(double seconds, const protocols::TrialView& next) override;
    [[nodiscard]] protocols::Signal pause(const protocols::TrialView& next) override;
    [[nodiscard]] std::optional<protocols::Signal> trouble(
        const protocols::TroubleView& view) override;
    void finish(const protocols::SessionView& session) override;

    /// The window and what keys mean, for whoever shows something else in between.
    [[nodiscard]] Stage& stage() { return stage_; }

private:
    [[nodiscard]] protocols::Signal wait_for_go();
    /// The same at the start of an interval.
    [[nodiscard]] protocols::Signal wait_at_start(ReadyFace face, bool checks_desk);
    [[nodiscard]] std::optional<StartMark> look_at_start(bool refused) const;
    /// Presses so far were meant for another screen, and those of the guard time are not for this
    /// one.
    /// @param shown_ns  when it was
    bool guard(std::int64_t shown_ns);
    /// One of the answers on cards().
    /// @param cards    where they stand now: a window may change its size meanwhile
    /// @param show     draws them with the one that is marked
    /// @param question  says whether it can be changed until Enter, or the same one again, confirms
    ///                  it, and when it is too late
    [[nodiscard]] protocols::Choice pick(
        const std::function<std::vector<Card>()>& cards,
        const protocols::Question& question,
        const std::function<std::int64_t(std::optional<std::size_t>)>& show);
    [[nodiscard]] PointerMap pointer_map();
    void begin_exploring();
    void pass_on(const Input& input);
    void hold(bool held);

    SubjectScreenOptions options_;
    Stage stage_;
    std::optional<ExploreFace> exploring_;  ///< what is shown while an object is felt
    std::optional<TroubleFace> in_trouble_;
};

/// A window onto a session that `observer` answers, and people look on. It outlives the screen.
[[nodiscard]] std::unique_ptr<protocols::Observer> spectator_screen(
    protocols::Observer& observer, const SubjectScreenOptions& options);

}  // namespace palpate::ui
