#include "ui/cli/study_advice.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/friction/laws/law.hpp"
#include "protocols/design/plan_summary.hpp"
#include "protocols/file/keys.hpp"
#include "ui/subject/font.hpp"

namespace palpate::ui {
namespace {

using protocols::InstructionTexts;

/// From here on more than 1 in 16,000 samples of Gaussian noise are beyond full scale, dB.
constexpr double kCutsPeaks = -12.0;

/// Longer without a break, s, and attention falls.
constexpr double kLongStretch = 20.0 * 60.0;
constexpr double kLongSession = 90.0 * 60.0;  ///< s

/// Of times, breaks and trials.
void advise_on_plan(const protocols::Protocol& protocol,
                    const protocols::Plan& plan,
                    std::vector<std::string>& all) {
    const Stretch stretch = longest_stretch(protocol, plan);
    if (stretch.seconds > kLongStretch) {
        all.push_back(fmt::format(
            "trials {} to {} take some {:.0f} minutes without a break: give [design] a "
            "smaller break_every",
            stretch.first + 1, stretch.first + stretch.trials, std::ceil(stretch.seconds / 60.0)));
    }
    if (const double all_of_it = duration_of(plan, protocol).prompted; all_of_it > kLongSession) {
        all.push_back(fmt::format("a session of {:.0f} minutes tires people: part it into several",
                                  std::ceil(all_of_it / 60.0)));
    }
    const auto trials_of = [&plan](protocols::Phase phase) {
        return std::ranges::count(plan.trials, phase, &protocols::PlannedTrial::phase);
    };
    const bool random = protocol.design.order == protocols::OrderRule::random;
    const int leads_in = protocol.procedure || random ? 0 : 1;
    if (trials_of(protocols::Phase::practice) == leads_in) {
        all.push_back(fmt::format(
            "there is no practice: the first answers that count are given by people who learn; "
            "give {}",
            protocol.procedure ? "[procedure] practice_trials" : "[design] practice_repetitions"));
    }
    if (!protocol.procedure && random && trials_of(protocols::Phase::catch_trial) == 0) {
        all.push_back(
            "there are no catch trials, so who only guesses is not distinguished from who cannot "
            "feel it; give [design] catch_trials");
    }
}

/// Motors and links sound otherwise on another friction.
bool compares_friction(const protocols::Protocol& protocol) {
    return protocol.frictions.size() > 1 ||
           (protocol.procedure && protocol.procedure->varies == protocols::Varies::mu);
}

std::vector<std::string_view> what_it_does(const engine::LawTraits& law) {
    std::vector<std::string_view> does;
    if (law.creeps) {
        does.emplace_back("creeps under a load that it should hold");
    }
    if (law.chatters) {
        does.emplace_back("chatters where an encoder counts once in several ticks");
    }
    if (!law.passive) {
        does.emplace_back("is not passive, so the energy limit may end a trial");
    }
    return does;
}

/// Laws of friction that do what nobody may have meant: they creep, chatter or give energy.
void advise_on_laws(const protocols::Protocol& protocol, std::vector<std::string>& all) {
    for (const protocols::FrictionSpec& friction : protocol.frictions) {
        const engine::LawTraits* const named = engine::law_named(friction.law);
        if (named == nullptr) {
            continue;
        }
        const engine::LawTraits& law = *named;
        const bool spring = law.reads.front() == "tangential_stiffness";
        const double stiffness =
            friction.own.stiffness > 0.0 ? friction.own.stiffness : protocol.apparatus.stiffness;
        const double max = friction.mu_s * protocol.apparatus.force_limit;
        const double stored = 0.5 * max * max / stiffness;
        if (spring && stored > protocol.safety.energy_limit) {
            all.push_back(
                fmt::format("friction \"{}\": a spring of {:g} N/m along the surface gives back up "
                            "to {:.2g} J, above energy_limit_j = {:g}, at which a trial ends: give "
                            "a stiffer one, or a higher limit",
                            friction.name, stiffness, stored, protocol.safety.energy_limit));
        }
        const std::vector<std::string_view> does = what_it_does(law);
        if (!does.empty()) {
            all.push_back(
                fmt::format("friction \"{}\": the law {} ({}) {}; \"gos\" does none of that",
                            friction.name, law.word, law.paper, fmt::join(does, ", ")));
        }
    }
}

/// Instructions that stand in another language alone.
void advise_on_language(const protocols::Protocol& protocol, std::vector<std::string>& all) {
    const auto chosen = static_cast<std::size_t>(protocol.language);
    for (const auto& key : protocols::keys_of<InstructionTexts>()) {
        const auto is_empty = [&](std::size_t language) {
            InstructionTexts texts = protocol.instructions.at(language);
            return std::get<std::string*>(key.slot(&texts))->empty();
        };
        for (std::size_t other = 0; other < protocols::kLanguageCount; ++other) {
            if (is_empty(chosen) && !is_empty(other)) {
                all.push_back(fmt::format(
                    "the screen is in {0}, and [instructions.{0}] has no {1}, [instructions.{2}] "
                    "has: the screen's own sentence is shown",
                    protocols::kLanguages.at(chosen), key.name, protocols::kLanguages.at(other)));
            }
        }
    }
}

/// Words that the screen shows otherwise than they were written.
void advise_on_letters(const protocols::Protocol& protocol,
                       const std::string& font,
                       std::vector<std::string>& all) {
    const auto look = [&](const std::string& where, const std::string& text) {
        const Unshown letters = unshown(text, font);
        const auto advise = [&](const std::string& letter, const char* why) {
            if (!letter.empty()) {
                all.push_back(fmt::format("{} has \"{}\": {}", where, letter, why));
            }
        };
        advise(letters.lacking, "the font lacks it, give --font one that has it");
        advise(letters.from_right, "what runs from right to left is not drawn so");
    };
    look("[response] question", protocol.response.question);
    look("[response] low", protocol.response.low);
    look("[response] high", protocol.response.high);
    InstructionTexts texts = protocol.instructions.at(static_cast<std::size_t>(protocol.language));
    for (const auto& key : protocols::keys_of<InstructionTexts>()) {
        look(fmt::format("[instructions.{}] {}", protocols::word_of(protocol.language), key.name),
             *std::get<std::string*>(key.slot(&texts)));
    }
}

}  // namespace

Stretch longest_stretch(const protocols::Protocol& protocol, const protocols::Plan& plan) {
    Stretch longest;
    Stretch now;
    for (const protocols::PlannedTrial& trial : plan.trials) {
        if (trial.break_before) {
            now = {.first = trial.position};
        }
        ++now.trials;
        longest = now.trials > longest.trials ? now : longest;
    }
    if (longest.trials > 0) {
        protocols::Plan alone;
        alone.trials.assign(longest.trials, protocols::PlannedTrial{});
        longest.seconds = duration_of(alone, protocol).prompted;
    }
    return longest;
}

std::vector<std::string> advice_on(const protocols::Protocol& protocol,
                                   const protocols::Plan& plan,
                                   const std::string& font,
                                   bool motors) {
    std::vector<std::string> all;
    advise_on_plan(protocol, plan, all);
    advise_on_laws(protocol, all);
    if (motors && compares_friction(protocol) && protocol.masking.noise == protocols::Noise::none) {
        all.push_back(
            "friction is compared without masking noise, and motors can be heard: give [masking] "
            "noise = \"pink\"");
    }
    advise_on_language(protocol, all);
    if (!font.empty()) {
        advise_on_letters(protocol, font, all);
    }
    if (protocol.masking.noise != protocols::Noise::none &&
        protocol.masking.level_db > kCutsPeaks) {
        all.push_back(
            fmt::format("masking noise at {:g} dB is cut at full scale now and then, which sounds "
                        "harsh: stay at {:g} dB or below and turn the headphones up",
                        protocol.masking.level_db, kCutsPeaks));
    }
    return all;
}

}  // namespace palpate::ui
