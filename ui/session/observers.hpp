#pragma once

#include <memory>

#include "protocols/design/plan.hpp"
#include "protocols/session/operator_desk.hpp"
#include "protocols/trial/apparatus.hpp"
#include "protocols/trial/observer.hpp"
#include "ui/live/live_session.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// Whoever answers, and the simulated observer behind a window that people only watch.
struct Observers {
    std::unique_ptr<protocols::Observer> simulated;
    std::unique_ptr<protocols::Observer> screen;

    [[nodiscard]] protocols::Observer& port() const { return screen ? *screen : *simulated; }
};

/// The screen of a person needs no plan: a window that cannot be had is said before a session is
/// made.
[[nodiscard]] Observers observers_before_the_plan(const RigSpec& spec,
                                                  protocols::Apparatus& apparatus,
                                                  protocols::OperatorDesk& desk,
                                                  LiveSession& live);

void add_simulated_observer(Observers& observers,
                            const RigSpec& spec,
                            const protocols::Plan& plan,
                            protocols::Apparatus& apparatus,
                            protocols::OperatorDesk& desk,
                            LiveSession& live);

}  // namespace palpate::ui
