#include "ui/cli/study_advice.hpp"

#include <fmt/format.h>

#include "protocols/format/keys.hpp"

namespace palpate::ui {
namespace {

using protocols::InstructionTexts;

/// From here on more than 1 in 16,000 samples of Gaussian noise are beyond full scale, dB.
constexpr double kCutsPeaks = -12.0;

}  // namespace

std::vector<std::string> advice_on(const protocols::Protocol& protocol) {
    std::vector<std::string> all;
    const auto chosen = static_cast<std::size_t>(protocol.language);
    const InstructionTexts& shown = protocol.instructions.at(chosen);
    for (const auto& key : protocols::keys_of<InstructionTexts>()) {
        const auto member = std::get<std::string InstructionTexts::*>(key.member);
        for (std::size_t other = 0; other < protocols::kLanguageCount; ++other) {
            if ((shown.*member).empty() && !(protocol.instructions.at(other).*member).empty()) {
                all.push_back(fmt::format(
                    "the screen is in {0}, and [instructions.{0}] has no {1}, [instructions.{2}] "
                    "has: the screen's own sentence is shown",
                    protocols::kLanguages.at(chosen), key.name, protocols::kLanguages.at(other)));
            }
        }
    }
    if (protocol.masking.noise != protocols::Noise::none &&
        protocol.masking.level_db > kCutsPeaks) {
        all.push_back(
            fmt::format("masking noise at {:g} dB is cut at full scale now and then, which sounds "
                        "harsh: stay at "
                        "{:g} dB or below and turn the headphones up",
                        protocol.masking.level_db, kCutsPeaks));
    }
    return all;
}

}  // namespace palpate::ui
