#pragma once

#include <functional>
#include <optional>
#include <string>

#include "protocols/running/observer.hpp"
#include "ui/subject/faces.hpp"
#include "ui/subject/pointer_map.hpp"
#include "ui/subject/stage.hpp"

namespace palpate::ui {

struct SubjectScreenOptions {
    WindowOptions window{};
    std::string watermark;              ///< "SIMULATED", "PILOT" or nothing
    std::function<bool()> interrupted;  ///< a signal asks the session to end
    /// The pointer is the handle: called with every position of it, object frame, m. Empty: it is not.
    std::function<void(const engine::Vec2&)> on_pointer;
    engine::Vec2 start{0.0, 0.060};  ///< where a pointer starts exploring, m
};

/// A person at the subject's screen. Times are of CLOCK_MONOTONIC, taken when a press is seen; how late
/// that may be is stored with each.
class SubjectScreen : public protocols::Observer {
public:
    explicit SubjectScreen(SubjectScreenOptions options);

    [[nodiscard]] protocols::Signal welcome(const protocols::SessionView& session) override;
    [[nodiscard]] protocols::Signal ready(const protocols::TrialView& trial) override;
    [[nodiscard]] protocols::Exploring explore(const protocols::TrialView& trial,
                                               double elapsed_s) override;
    [[nodiscard]] protocols::Choice choose(const protocols::TrialView& trial,
                                           std::span<const protocols::Picture> pictures) override;
    [[nodiscard]] protocols::Signal gap(double seconds) override;
    [[nodiscard]] protocols::Signal rest(double seconds, const protocols::TrialView& next) override;
    void finish(const protocols::SessionView& session) override;

    [[nodiscard]] Stage& stage() { return stage_; }

private:
    [[nodiscard]] protocols::Signal wait_for_go();
    void follow_pointer(const Input& input);

    SubjectScreenOptions options_;
    Stage stage_;
    std::optional<ExploreFace> exploring_;  ///< what is shown while an object is felt
};

}  // namespace palpate::ui
