#include "protocols/session/trust.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace palpate::protocols {
namespace {

using engine::Trip;

/// Causes that lie with people, screen, machine or program.
constexpr std::array kElsewhere{Trip::stopped,       Trip::focus_lost, Trip::let_go,
                                Trip::time_limit,    Trip::late,       Trip::delayed,
                                Trip::screen_silent, Trip::overheated, Trip::none};
/// Causes after which the board may be another one, or begin anew.
constexpr std::array kAway{Trip::device_lost, Trip::device_silent, Trip::device_stopped,
                           Trip::device_garbage};

bool among(std::span<const Trip> causes, std::string_view word) noexcept {
    return std::any_of(causes.begin(), causes.end(),
                       [word](Trip cause) { return to_string(cause) == word; });
}

RigTrust lowered_to(RigTrust trust, Trust state) noexcept {
    return {.state = std::min(trust.state, state), .trials = trust.trials};
}

RigTrust after_fault(RigTrust trust, std::string_view cause) noexcept {
    if (among(kElsewhere, cause)) {
        return trust;
    }
    return lowered_to(trust, among(kAway, cause) ? Trust::unknown : Trust::answers);
}

RigTrust after_proof(RigTrust trust, const Event& event) noexcept {
    if (event.value == kRefused) {
        return lowered_to(trust, Trust::answers);
    }
    if (event.key == kStartPose) {
        return {.state = Trust::at_home};
    }
    return event.key == kRigCheck && trust.state >= Trust::at_home ? RigTrust{Trust::proved}
                                                                   : trust;
}

ProofStep stepped(const engine::ShortForm& form, std::string_view key, std::string_view what) {
    if (!form.refused.empty()) {
        return {.event = {}, .refused = form.refused};
    }
    return {.event = Event{.kind = EventKind::provenance,
                           .text = fmt::format("{}: {}", what, form.found),
                           .key = std::string(key),
                           .value = form.found},
            .refused = {}};
}

}  // namespace

RigTrust apply(RigTrust trust, const Attempt& /*attempt*/) noexcept {
    ++trust.trials;
    return trust.trials < kMaxTrialsOfAProof ? trust : lowered_to(trust, Trust::answers);
}

RigTrust apply(RigTrust trust, const Event& event) noexcept {
    switch (event.kind) {
        case EventKind::fault:
            return after_fault(trust, event.value);
        case EventKind::rest:
        case EventKind::pause:
            return lowered_to(trust, Trust::answers);
        case EventKind::reconnect:
            return {.state = std::max(trust.state, Trust::answers), .trials = trust.trials};
        case EventKind::provenance:
            return after_proof(trust, event);
        default:
            return trust;
    }
}

ProofStep prove_step(Apparatus& apparatus, Trust state) {
    if (state == Trust::at_home) {
        return stepped(apparatus.prove_motors(), kRigCheck, kHandleMoves);
    }
    if (state == Trust::answers) {
        return stepped(apparatus.prove_place(), kStartPose, "the handle is where it should be");
    }
    if (apparatus.reconnect()) {
        return {.event = Event{.kind = EventKind::reconnect, .text = "the device works"},
                .refused = {}};
    }
    return {.event = {}, .refused = apparatus.trouble()};
}

}  // namespace palpate::protocols
