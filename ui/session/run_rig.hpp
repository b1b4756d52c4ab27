#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "protocols/session/session.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/database.hpp"
#include "data/store/session_store.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/device_choice.hpp"
#include "ui/session/load_study.hpp"

namespace palpate::ui {

/// How a session is shown and paced; shared by run and demo.
struct ScreenOptions {
    bool headless = false;    ///< no window: the simulated observer answers
    bool fullscreen = false;  ///< whatever the kind; real sessions are, unless windowed
    bool windowed = false;
    std::string font;       ///< a TTF file; empty: DejaVu Sans of the system
    double speed = 0.0;     ///< multiple of real time of simulated and replayed hands, 0: default
    bool no_sound = false;  ///< no masking noise, whatever the protocol asks for
};
void add_screen_words(Words& words, ScreenOptions& screen);

/// What a session is run on: the parts behind its three ports.
struct RigSpec {
    Study study;
    protocols::SessionKey key;
    std::uint64_t seed = 0;
    data::RunKind kind = data::RunKind::simulated;
    DeviceChoice device;
    std::string calibration;  ///< a file or a shipped machine's name; empty: the device's own
    std::vector<protocols::ReplayApparatus::Recording> recordings;  ///< of a replay
    ScreenOptions screen;
    data::Resume resume = data::Resume::go_on;
    std::string operator_name;  ///< kept with the session; empty: not given
    bool durable = false;       ///< ticks are saved within 45 ms instead of 120 ms
    double spin_share = 0.0;    ///< of real devices, see engine::ServoSpec
    std::string go_on;          ///< the command that resumes it; empty: nobody is told
    bool watch_only =
        false;  ///< in a window the simulated observer answers, and people watch (demo)
};

/// How a session went, for the command to report.
struct RigEnd {
    protocols::SessionEnd session{};
    bool already_finished = false;
    std::string
        head{};  ///< of the session's chain of hashes (data/store/chain.hpp); empty: none yet
};

/// The recorded hands that a replay asks for; nothing for other devices.
/// @throws data::StoreError, data::TraceError if the file or its ticks are not there
/// @throws std::invalid_argument if there is no such trial
[[nodiscard]] std::vector<protocols::ReplayApparatus::Recording> load_recordings(
    const DeviceChoice& device);

/// A window can be opened here and was not declined.
/// @throws std::invalid_argument if a display is named and cannot be opened: nobody would see the session
[[nodiscard]] bool wants_window(const ScreenOptions& screen);

/// Plans, opens or resumes the session in `database`, and runs it to its end. Prints a line when it
/// starts and one for every trial, to standard output.
/// @throws what the parts throw; the force is off and everything recorded is kept
[[nodiscard]] RigEnd run_rig(data::Database& database, const RigSpec& spec);

}  // namespace palpate::ui
