#include "ui/rig/fault_text.hpp"

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "ui/rig/operator_log.hpp"

namespace palpate::ui {

namespace {

std::string without_stop(std::string sentence) {
    while (sentence.ends_with('.') || sentence.ends_with('\n')) {
        sentence.pop_back();
    }
    return sentence;
}

}  // namespace

std::string fault_text(const protocols::Fault& fault) {
    const std::string what =
        without_stop(fault.text.empty() ? std::string(explanation(fault.cause)) : fault.text);
    return fmt::format("fault: {}", what);
}

std::string display_lost_text(const protocols::SessionEnd& end) {
    return fmt::format(
        "the display is gone. The force is off and what was recorded is kept; where a display "
        "works again, the same command goes on at {}",
        number_text(end.number));
}

std::string given_up_text(const protocols::SessionEnd& end) {
    const std::string after = end.tries > 0
                                ? counted(end.tries, "try", "tries") + " to reach the device again"
                                : counted(end.in_a_row, "fault") + " in a row";
    return fmt::format(
        "gave up after {}: {}. The force is off and what was recorded is kept; the "
        "same command goes on at {}",
        after, without_stop(end.fault), number_text(end.number));
}

}  // namespace palpate::ui
