#pragma once

#include "protocols/trial/observer.hpp"
#include "ui/subject/subject_screen.hpp"

namespace palpate::ui {

/// A window onto a simulated session: another observer answers, people look on. Shows what a
/// participant would see, at a pace that can be followed.
class SpectatorScreen : public protocols::Observer {
public:
    /// @param observer  who answers; outlives this one
    SpectatorScreen(protocols::Observer& observer, const SubjectScreenOptions& options);

    [[nodiscard]] protocols::Signal welcome(const protocols::SessionView& session) override;
    [[nodiscard]] protocols::Signal ready(const protocols::TrialView& trial) override;
    [[nodiscard]] protocols::ExplorationStep explore(const protocols::TrialView& trial,
                                                     double elapsed_s) override;
    void feel(std::span<const engine::TickRecord> ticks) override { observer_.feel(ticks); }
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

private:
    protocols::Observer& observer_;
    protocols::ResponseKind asks_;
    Stage stage_;
    std::optional<ExploreFace> exploring_;
    std::optional<TroubleFace> in_trouble_;
};

}  // namespace palpate::ui
