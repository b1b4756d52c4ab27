#pragma once

#include <string>
#include <vector>

#include "protocols/design/protocol.hpp"

namespace palpate::ui {

/// What may be meant otherwise in a protocol that is right, a sentence each: instructions that the chosen
/// language lacks, noise so loud that its peaks are cut.
[[nodiscard]] std::vector<std::string> advice_on(const protocols::Protocol& protocol);

}  // namespace palpate::ui
