#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "protocols/design/plan.hpp"
#include "protocols/session/operator_desk.hpp"
#include "protocols/trial/apparatus.hpp"
#include "protocols/trial/observer.hpp"
#include "data/store/database.hpp"
#include "data/store/session_store.hpp"
#include "ui/command/command.hpp"
#include "ui/live/live_board.hpp"
#include "ui/live/live_session.hpp"
#include "ui/rig/stop_lines.hpp"
#include "ui/session/open_apparatus.hpp"
#include "ui/session/rig.hpp"
#include "ui/sound/noise_player.hpp"

namespace palpate::ui {

/// A session on its way, for whatever shows it, answers in it or stops its force. All outlive that.
struct RunningRig {
    const RigSpec& spec;
    protocols::Apparatus& apparatus;
    protocols::OperatorDesk& desk;
    LiveSession& live;
};

/// The words of every command that shows a session.
void add_screen_words(CommandWords& words, ScreenOptions& screen);

/// A window can be opened here and was not declined.
/// @throws std::invalid_argument if a display is named and cannot be opened: nobody would see the
/// session; or if its monitor or font is not there
[[nodiscard]] bool wants_window(const ScreenOptions& screen);

/// What those who look on see of a session beside what happens in it; of its screen and its noise
/// nothing yet.
[[nodiscard]] LiveFacts live_facts(const RigSpec& spec,
                                   const OpenedApparatus& felt,
                                   data::Database& database,
                                   const data::OpenedSession& opened);

/// Whoever answers, and the simulated observer behind a window that people only watch.
struct Observers {
    std::unique_ptr<protocols::Observer> simulated;
    std::unique_ptr<protocols::Observer> screen;

    [[nodiscard]] protocols::Observer& port() const { return screen ? *screen : *simulated; }
};

/// The screen of a person needs no plan: a window that cannot be had is said before a session is
/// made.
[[nodiscard]] Observers observers_before_the_plan(const RunningRig& rig);

void add_simulated_observer(Observers& observers,
                            const RunningRig& rig,
                            const protocols::Plan& plan);

/// The masking noise of a session.
struct OpenedMasking {
    std::unique_ptr<NoisePlayer> player;  ///< none: the session is silent
    std::string note;                     ///< for the record; empty: the protocol asks for no noise
    bool required = false;                ///< without it no trial may begin
};

/// Opens what the protocol asks for, for people alone: nothing is played for simulated hands. With
/// --no-sound, and in a pilot without a sound device, the session is silent, and standard error and
/// the note say so.
/// @throws std::runtime_error in a real session without a sound device that somebody may hear
[[nodiscard]] OpenedMasking open_masking(const RigSpec& spec);

/// What stops the force without the window, and what others may ask of a session that is shown. The
/// desk hears of a stop first, so that no trial begins unheard.
[[nodiscard]] std::unique_ptr<StopLines> stop_lines(const data::Database& database,
                                                    const RunningRig& rig);

/// How many seals of a session do not hold before it goes on. Said: what is recorded from here on
/// gets seals that do.
[[nodiscard]] std::size_t said_breaks(data::Database& database, const data::OpenedSession& opened);

/// After what nobody can mend in here, as a full disk, the participant's screen asks for a moment
/// until the experimenter has come. The force is off.
void keep_screen(protocols::Observer& screen, protocols::OperatorDesk& desk, const char* why);

}  // namespace palpate::ui
