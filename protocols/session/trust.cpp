#include "protocols/session/trust.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::protocols {
namespace {

using engine::Trip;

/// Causes that lie with people, screen, machine or program, and are soon over.
constexpr std::array kElsewhere{Trip::stopped,       Trip::focus_lost, Trip::let_go,
                                Trip::time_limit,    Trip::late,       Trip::delayed,
                                Trip::screen_silent, Trip::none};
/// Causes after which the board may be another one, or begin anew.
constexpr std::array kAway{Trip::device_lost, Trip::device_silent, Trip::device_stopped,
                           Trip::device_garbage};

bool among(std::span<const Trip> causes, std::string_view word) noexcept {
    return std::ranges::any_of(causes, [word](Trip cause) { return to_string(cause) == word; });
}

RigTrust lowered_to(RigTrust trust, Trust state) noexcept {
    trust.state = std::min(trust.state, state);
    return trust;
}

RigTrust after_fault(RigTrust trust, std::string_view cause) noexcept {
    if (among(kElsewhere, cause)) {
        return trust;
    }
    const bool away = among(kAway, cause);
    trust.by_hand = trust.by_hand || away;
    return lowered_to(trust, away ? Trust::unknown : Trust::answers);
}

RigTrust after_reconnect(RigTrust trust, const Event& event) noexcept {
    const bool anew = event.value == kAnew;
    trust.by_hand = trust.by_hand || anew;
    trust.state = anew ? Trust::answers : std::max(trust.state, Trust::answers);
    return trust;
}

/// A stop takes trust when it is over: until then nothing moves the rig, pulses neither.
RigTrust after_going_on(RigTrust trust, const Event& event) noexcept {
    trust.by_hand = false;
    const bool stopped = event.value == to_string(Trip::stopped);
    return stopped || event.duration_s > kLongTrouble ? lowered_to(trust, Trust::answers) : trust;
}

RigTrust after_proof(RigTrust trust, const Event& event) noexcept {
    if (event.value == kRefused || event.value == kRefusedInTrouble) {
        trust.place_old = trust.place_old || trust.state == Trust::at_home;  // it was the pulses
        return lowered_to(trust, event.value == kRefused ? Trust::answers : Trust::at_home);
    }
    const bool moved = event.key == kRigCheck && trust.state >= Trust::at_home;
    if (event.key == kStartPose || moved) {
        trust.state = !moved ? Trust::at_home : trust.place_old ? Trust::answers : Trust::proved;
        trust.place_old = false;
        trust.trials = moved ? 0 : trust.trials;  // a handle at home says nothing of motors
    }
    return trust;
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

ProofStep works_again(bool anew) {
    return {
        .event = Event{.kind = EventKind::reconnect,
                       .text = anew ? "the device works, but it began anew" : "the device works",
                       .value = std::string(anew ? kAnew : "")},
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
            return after_reconnect(trust, event);
        case EventKind::go_on:
            return after_going_on(trust, event);
        case EventKind::provenance:
            return after_proof(trust, event);
        default:
            return trust;
    }
}

ProofStep prove_step(Apparatus& apparatus, Trust state) {
    if (!apparatus.reconnect()) {
        return {.event = {}, .refused = apparatus.trouble()};
    }
    const bool came_anew = apparatus.began_anew();
    if (state == Trust::unknown || came_anew) {
        return works_again(came_anew);
    }
    ProofStep step =
        state == Trust::at_home
            ? stepped(apparatus.prove_motors(), kRigCheck, kHandleMoves)
            : stepped(apparatus.prove_place(), kStartPose, "the handle is where it should be");
    // Found right, but somewhere else.
    return apparatus.began_anew() ? works_again(true) : step;
}

Event refused_proof(const RigTrust& trust, const std::string& why, std::string_view value) {
    const std::string since = trust.trials == 0
                                ? std::string()
                                : fmt::format(". Doubtful: the last {}, begun since it was right",
                                              counted(trust.trials, "attempt", "attempts"));
    return {.kind = EventKind::provenance,
            .text = why + since,
            .count = static_cast<std::int64_t>(trust.trials),
            .key = std::string(kRigCheck),
            .value = std::string(value)};
}

std::optional<Event> other_board(const Event& event,
                                 const Apparatus& apparatus,
                                 std::string& board) {
    if (event.kind != EventKind::reconnect || apparatus.identity() == board) {
        return std::nullopt;
    }
    board = apparatus.identity();
    return Event{.kind = EventKind::provenance,
                 .text = fmt::format("{}: {}", kBoard, board),
                 .key = std::string(kBoard),
                 .value = board};
}

HandleCheck::HandleCheck(Apparatus& apparatus, const RigTrust& trust)
    : apparatus_(apparatus), trust_(trust) {
    if (apparatus.has_proof()) {
        thread_ = std::thread([this] { live(); });
    } else {
        over_.store(true);
    }
}

HandleCheck::~HandleCheck() {
    finish();
    if (thread_.joinable()) {
        thread_.join();
    }
}

void HandleCheck::live() {
    constexpr auto kSlice = std::chrono::milliseconds(20);
    do {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kLetGo);
        while (resting_.load() && std::chrono::steady_clock::now() < end) {
            std::this_thread::sleep_for(kSlice);
        }
        try {
            prove();
        } catch (const std::exception& e) {
            refused_ = e.what();
        }
    } while (resting_.load() && !refused_.empty());
    over_.store(true);
}

void HandleCheck::prove() {
    refused_.clear();
    while (trust_.state != Trust::proved && refused_.empty()) {
        ProofStep step = prove_step(apparatus_, trust_.state);
        refused_ = std::move(step.refused);
        trust_ = apply(
            trust_, step.event ? *step.event : refused_proof(trust_, refused_, kRefusedInTrouble));
        if (step.event) {
            proved_.push_back(*std::move(step.event));
        }
    }
}

}  // namespace palpate::protocols
