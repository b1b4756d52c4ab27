#include "protocols/trial/observer.hpp"

namespace palpate::protocols {

Signal Observer::feedback(const TrialView& /*trial*/, bool /*correct*/) {
    return Signal::go_on;
}

Signal Observer::pause(const TrialView& /*next*/) {
    return Signal::go_on;
}

std::optional<Signal> Observer::trouble(const TroubleView& view) {
    if (view.tries >= kMaxTries || view.in_a_row >= kMaxFaults) {
        return Signal::give_up;
    }
    return view.solved ? std::optional(Signal::go_on) : std::nullopt;
}

}  // namespace palpate::protocols
