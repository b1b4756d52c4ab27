#include "ui/session/open_masking.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "protocols/design/session_plan.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

OpenedMasking silent(const std::string& why) {
    warn("no masking noise: {}", why);
    return {.player = nullptr, .note = "none: " + why};
}

}  // namespace

OpenedMasking open_masking(const RigSpec& spec) {
    const protocols::MaskingSpec& asked = spec.study.protocol.masking;
    if (asked.noise == protocols::Noise::none || !held_by_a_person(spec.device.kind)) {
        return {};
    }
    if (spec.screen.no_sound) {
        return silent("--no-sound was given");
    }
    OpenedMasking opened{
        .player = nullptr, .note = {}, .required = spec.kind == data::RunKind::real};
    try {
        opened.player =
            open_noise(asked, protocols::session_stream(spec.study.hash, spec.key, spec.seed));
    } catch (const std::runtime_error& error) {
        if (opened.required) {
            throw;
        }
        return silent(error.what());
    }
    opened.note = opened.player->name();
    if (!opened.player->audible()) {
        if (opened.required) {
            throw std::runtime_error(
                fmt::format("masking noise ({}) would reach nobody: leave SDL_AUDIODRIVER unset, "
                            "or give --no-sound",
                            opened.note));
        }
        warn("the masking noise ({}) reaches nobody", opened.note);
    }
    return opened;
}

}  // namespace palpate::ui
