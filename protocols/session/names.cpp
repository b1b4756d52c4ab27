#include "protocols/session/recorder.hpp"
#include "protocols/trial/observer.hpp"

namespace palpate::protocols {

std::string_view to_string(InputKind kind) noexcept {
    switch (kind) {
        case InputKind::simulated:
            return "simulated";
        case InputKind::key:
            return "key";
        case InputKind::arrows:
            return "arrows";
        case InputKind::mouse:
            return "mouse";
    }
    return "?";
}

std::string_view to_string(Outcome outcome) noexcept {
    switch (outcome) {
        case Outcome::complete:
            return "complete";
        case Outcome::timed_out:
            return "timed_out";
        case Outcome::aborted:
            return "aborted";
        case Outcome::interrupted:
            return "interrupted";
        case Outcome::faulted:
            return "faulted";
    }
    return "?";
}

}  // namespace palpate::protocols
