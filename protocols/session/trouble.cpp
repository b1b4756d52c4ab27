#include "protocols/session/trouble.hpp"

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::protocols {

Mended mend(Ports& ports, const Fault& fault, std::size_t in_a_row) {
    TroubleView view{.sentence = fault.text,
                     .in_a_row = in_a_row,
                     .by_hand = fault.cause == engine::Trip::stopped};
    for (std::size_t slice = 0;; ++slice) {
        if (!view.solved && slice % kSlicesPerTry == 0) {
            view.solved = ports.apparatus.reconnect();
            if (view.solved) {
                view.sentence = fault.text;  // no longer why it could not be reached
                ports.recorder.event({.kind = EventKind::reconnect,
                                      .text = "the device works, after " +
                                              counted(view.tries, "try", "tries") + " in vain",
                                      .count = static_cast<std::int64_t>(view.tries)});
            } else {
                ++view.tries;
                const std::string trouble = ports.apparatus.trouble();
                view.sentence = trouble.empty() ? fault.text : trouble;
            }
        }
        if (ports.interrupted()) {
            return {Signal::abort, view.tries};
        }
        const std::optional<Signal> said = ports.observer.trouble(view);
        if (said == Signal::abort || said == Signal::give_up) {
            return {*said, view.tries};
        }
        if (said == Signal::go_on && view.solved) {
            const bool tripped = fault.cause != engine::Trip::none;
            const std::string cause(tripped ? to_string(fault.cause) : kRigCheck);
            ports.recorder.event(
                {.kind = EventKind::go_on, .text = fmt::format("after {}", cause), .value = cause});
            return {Signal::go_on, view.tries};
        }
        ports.pause(kTroubleSlice);
    }
}

}  // namespace palpate::protocols
