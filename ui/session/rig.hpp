#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocols/file/calibration_file.hpp"
#include "protocols/protocol/observer_model.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "data/store/session_store.hpp"
#include "ui/rig/device_choice.hpp"
#include "ui/rig/stop_lines.hpp"
#include "ui/session/load_study.hpp"

namespace palpate::ui {

/// How a session is shown and paced; shared by run and demo.
struct ScreenOptions {
    bool headless = false;    ///< no window: the simulated observer answers
    bool fullscreen = false;  ///< whatever the kind; real sessions are, unless windowed
    bool windowed = false;
    int monitor = 0;        ///< 1 and up; 0: the first one
    std::string font;       ///< a TTF file; empty: DejaVu Sans of the system
    double speed = 0.0;     ///< multiple of real time of simulated and replayed hands, 0: default
    bool no_sound = false;  ///< no masking noise, whatever the protocol asks for
};

/// What a session is run on: the parts behind its three ports.
struct RigSpec {
    Study study;
    protocols::SessionKey key;
    std::uint64_t seed = 0;
    data::RunKind kind = data::RunKind::simulated;
    DeviceChoice device;
    std::optional<Behind> behind{};  ///< when `kind` was chosen; none: nobody asked
    protocols::HandSpec hand{};      ///< of a simulated hand
    protocols::RigFile rig{};  ///< of rig_file_of(); with a record it is proved when it is opened
    bool handle_free =
        false;  ///< the operator's word that it is, and at home, was given beforehand
    std::vector<protocols::ReplayApparatus::Recording> recordings;  ///< of a replay
    ScreenOptions screen;
    data::Resume resume = data::Resume::go_on;
    bool other_device = false;  ///< it goes on also on another device than its last trial had
    bool another = false;       ///< somebody new, although a code in the file is much like theirs
    bool new_version = false;   ///< the protocol was changed on purpose
    std::vector<std::string> said{};  ///< of admit(), before the rig's questions
    std::string operator_name;        ///< kept with the session; empty: not given
    bool durable = false;             ///< ticks are saved within 45 ms instead of 120 ms
    bool console = false;             ///< palpate console runs beside it
    double spin_share = 0.0;          ///< of real devices, see engine::ServoSpec
    std::string go_on;                ///< the command that resumes it; empty: nobody hears it
    std::shared_ptr<StopButton> stop_button{};  ///< of the rig; none: it has none
    bool watch_only =
        false;  ///< in a window the simulated observer answers, and people watch (demo)
};

}  // namespace palpate::ui
