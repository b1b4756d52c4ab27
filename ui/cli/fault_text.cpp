#include "ui/cli/fault_text.hpp"

#include <fmt/format.h>

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
    return fmt::format("  fault: {}; runs again later in its block", what);
}

std::string given_up_text(const protocols::SessionEnd& end) {
    const std::string after = end.tries > 0
                                ? fmt::format("{} tries to reach the device again", end.tries)
                                : fmt::format("{} faults in a row", end.in_a_row);
    return fmt::format(
        "gave up after {}: {}. The force is off and what was recorded is kept; the "
        "same command goes on at trial {}",
        after, without_stop(end.fault), end.next + 1);
}

}  // namespace palpate::ui
