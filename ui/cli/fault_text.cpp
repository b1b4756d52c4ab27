#include "ui/cli/fault_text.hpp"

#include <fmt/format.h>

namespace palpate::ui {

std::string fault_text(const protocols::Fault& fault) {
    std::string what = fault.text.empty() ? std::string(explanation(fault.cause)) : fault.text;
    while (what.ends_with('.') || what.ends_with('\n')) {
        what.pop_back();
    }
    return fmt::format("  fault: {}; runs again later in its block", what);
}

}  // namespace palpate::ui
