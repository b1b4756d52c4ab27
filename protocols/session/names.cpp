#include <algorithm>
#include <array>

#include "engine/base/refuse.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/observer.hpp"

namespace palpate::protocols {

std::string_view to_string(InputKind kind) noexcept {
    constexpr std::array<std::string_view, 4> kWords{"simulated", "key", "arrows", "mouse"};
    return kWords[static_cast<std::size_t>(kind)];
}

std::string_view to_string(Outcome outcome) noexcept {
    constexpr std::array<std::string_view, 6> kWords{"complete",    "timed_out", "aborted",
                                                     "interrupted", "faulted",   "unanswered"};
    return kWords[static_cast<std::size_t>(outcome)];
}

Outcome without_answer(std::string_view word) noexcept {
    for (const Outcome outcome : {Outcome::aborted, Outcome::faulted, Outcome::unanswered}) {
        if (word == to_string(outcome)) {
            return outcome;
        }
    }
    return Outcome::interrupted;
}

/// In the order of EventKind.
constexpr std::array<std::string_view, kEventKinds> kEventWords{
    "break",      "pause",       "go on",         "abort",        "gave up", "fault",
    "reconnect",  "invalid",     "note",          "mark",         "redo",    "interrupted",
    "timing",     "ticks lost",  "masking",       "display lost", "device",  "operator",
    "provenance", "participant", "planned again", "stop",         "reveal"};

std::string_view to_string(EventKind kind) noexcept {
    return kEventWords[static_cast<std::size_t>(kind)];
}

EventKind event_kind(std::string_view word) {
    const auto found = std::find(kEventWords.begin(), kEventWords.end(), word);
    refuse_if(found == kEventWords.end(), "no kind of event: {}", word);
    return static_cast<EventKind>(found - kEventWords.begin());
}

}  // namespace palpate::protocols
