#pragma once

#include <memory>
#include <string>

#include "ui/session/rig.hpp"
#include "ui/sound/noise_player.hpp"

namespace palpate::ui {

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

}  // namespace palpate::ui
