#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "engine/friction/laws/law.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/keys.hpp"
#include "data/plot/object_sheet.hpp"
#include "ui/cli/plan_text.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/open_apparatus.hpp"
#include "ui/subject/font.hpp"

namespace palpate::ui {
namespace {

struct CheckOptions {
    std::string protocol;        ///< a file, or the name of a shipped protocol
    std::string device = "sim";  ///< as RunOptions::device
    std::string calibration;     ///< as RunOptions::calibration
    std::string font;            ///< as ScreenOptions::font
    std::string svg;             ///< where to draw the objects; empty: nowhere
    bool tables = false;         ///< counts, limits and successions as well
};

using protocols::InstructionTexts;
using protocols::Phase;
using protocols::Plan;
using protocols::Protocol;

/// Whose plan is shown: counts, limits and length are the same for everybody.
constexpr const char* kExample = "example";

std::size_t trials_of(const Plan& plan, Phase phase) {
    return static_cast<std::size_t>(
        std::ranges::count(plan.trials, phase, &protocols::PlannedTrial::phase));
}

std::string minutes(double seconds) {
    return seconds < 100.0 ? fmt::format("{:.0f} s", std::ceil(seconds))
                           : fmt::format("{:.0f} min", std::ceil(seconds / 60.0));
}

/// Trials between two breaks, the most of them, and how long they take, s, each felt until the
/// prompt.
struct Stretch {
    std::size_t first = 0;  ///< position of its first trial
    std::size_t trials = 0;
    double seconds = 0.0;
};

/// Of several as long the first one.
Stretch longest_stretch(const Protocol& protocol, const Plan& plan) {
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
        Plan alone;
        alone.trials.assign(longest.trials, protocols::PlannedTrial{});
        longest.seconds = duration_of(alone, protocol).prompted;
    }
    return longest;
}

void print_title(const Study& study) {
    say("{}: {}\nprotocol {}\n", study.protocol.id, study.protocol.title, study.hash);
}

void print_duration(const Protocol& protocol, const Plan& plan) {
    const protocols::Duration duration = duration_of(plan, protocol);
    say("\nduration {} if every trial is felt until the prompt at {:g} s, with {:g} s to get ready "
        "and {:g} s\n  to answer, and every break takes {:g} s; {} if all are as quick as they may "
        "be, {} if all are felt\n  until the time-out. Instructions and trials that are run again "
        "come on top.\n",
        minutes(duration.prompted), protocol.timing.explore_prompt, protocols::kReadySeconds,
        choice_seconds(protocol), protocol.timing.break_min, minutes(duration.shortest),
        minutes(duration.longest));
    const Stretch stretch = longest_stretch(protocol, plan);
    say("{}longest stretch without a break: {}, {}\n", breaks_text(summarise(plan)),
        counted(stretch.trials, "trial"), minutes(stretch.seconds));
}

/// A sentence on what may be meant otherwise in a protocol that is right.
template <class... Values>
void advise(fmt::format_string<Values...> text, Values&&... values) {
    say("  warning: {}\n", fmt::format(text, std::forward<Values>(values)...));
}

/// From here on more than 1 in 16,000 samples of Gaussian noise are beyond full scale, dB.
constexpr double kCutsPeaks = -12.0;

/// Longer without a break, s, and attention falls.
constexpr double kLongStretch = 20.0 * 60.0;
constexpr double kLongSession = 90.0 * 60.0;  ///< s

/// Of times, breaks and trials.
void advise_on_plan(const Protocol& protocol, const Plan& plan) {
    const Stretch stretch = longest_stretch(protocol, plan);
    if (stretch.seconds > kLongStretch) {
        advise(
            "trials {} to {} take some {:.0f} minutes without a break: give [design] a "
            "smaller break_every",
            stretch.first + 1, stretch.first + stretch.trials, std::ceil(stretch.seconds / 60.0));
    }
    if (const double all_of_it = duration_of(plan, protocol).prompted; all_of_it > kLongSession) {
        advise("a session of {:.0f} minutes tires people: part it into several",
               std::ceil(all_of_it / 60.0));
    }
    const bool random = protocol.design.order == protocols::OrderRule::random;
    const std::size_t leads_in = protocol.procedure || random ? 0 : 1;
    if (trials_of(plan, Phase::practice) == leads_in) {
        advise(
            "there is no practice: the first answers that count are given by people who learn; "
            "give {}",
            protocol.procedure ? "[procedure] practice_trials" : "[design] practice_repetitions");
    }
    if (!protocol.procedure && random && trials_of(plan, Phase::catch_trial) == 0) {
        advise(
            "there are no catch trials, so who only guesses is not distinguished from who cannot "
            "feel it; give [design] catch_trials");
    }
}

/// Motors and links sound otherwise on another friction.
bool compares_friction(const Protocol& protocol) {
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
void advise_on_laws(const Protocol& protocol) {
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
            advise(
                "friction \"{}\": a spring of {:g} N/m along the surface gives back up "
                "to {:.2g} J, above energy_limit_j = {:g}, at which a trial ends: give "
                "a stiffer one, or a higher limit",
                friction.name, stiffness, stored, protocol.safety.energy_limit);
        }
        const std::vector<std::string_view> does = what_it_does(law);
        if (!does.empty()) {
            advise("friction \"{}\": the law {} ({}) {}; \"gos\" does none of that", friction.name,
                   law.word, law.paper, fmt::join(does, ", "));
        }
    }
}

/// Instructions that stand in another language alone.
void advise_on_language(const Protocol& protocol) {
    const auto chosen = static_cast<std::size_t>(protocol.language);
    for (const auto& key : protocols::keys_of<InstructionTexts>()) {
        const auto is_empty = [&](std::size_t language) {
            InstructionTexts texts = protocol.instructions.at(language);
            return std::get<std::string*>(key.slot(&texts))->empty();
        };
        for (std::size_t other = 0; other < protocols::kLanguageCount; ++other) {
            if (is_empty(chosen) && !is_empty(other)) {
                advise(
                    "the screen is in {0}, and [instructions.{0}] has no {1}, [instructions.{2}] "
                    "has: the screen's own sentence is shown",
                    protocols::kLanguages.at(chosen), key.name, protocols::kLanguages.at(other));
            }
        }
    }
}

/// Words that the screen shows otherwise than they were written.
void advise_on_letters(const Protocol& protocol, const std::string& font) {
    const auto look = [&](const std::string& where, const std::string& text) {
        const Unshown letters = unshown(text, font);
        const auto say_why = [&](const std::string& letter, const char* why) {
            if (!letter.empty()) {
                advise("{} has \"{}\": {}", where, letter, why);
            }
        };
        say_why(letters.lacking, "the font lacks it, give --font one that has it");
        say_why(letters.from_right, "what runs from right to left is not drawn so");
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

/// @return empty where none is installed, or nothing that reads it: a protocol can be looked at so
std::string font_of(const CheckOptions& options) {
    try {
        std::string font = find_font(options.font);
        static_cast<void>(unshown({}, font));
        return font;
    } catch (const std::runtime_error&) {
        if (!options.font.empty()) {
            throw;
        }
        return {};
    }
}

void print_advice(const Protocol& protocol, const Plan& plan, const CheckOptions& options) {
    const bool motors = gives_force(parse_device(options.device).kind);
    const std::string font = font_of(options);
    advise_on_plan(protocol, plan);
    advise_on_laws(protocol);
    if (motors && compares_friction(protocol) && protocol.masking.noise == protocols::Noise::none) {
        advise(
            "friction is compared without masking noise, and motors can be heard: give [masking] "
            "noise = \"pink\"");
    }
    advise_on_language(protocol);
    if (!font.empty()) {
        advise_on_letters(protocol, font);
    }
    if (protocol.masking.noise != protocols::Noise::none &&
        protocol.masking.level_db > kCutsPeaks) {
        advise(
            "masking noise at {:g} dB is cut at full scale now and then, which sounds "
            "harsh: stay at {:g} dB or below and turn the headphones up",
            protocol.masking.level_db, kCutsPeaks);
    }
}

void print_design(const Study& study, const Plan& plan) {
    const Protocol& protocol = study.protocol;
    say("\n{}, handedness {}, screen in {}\n", counted(protocol.participants, "participant"),
        protocols::word_of(protocol.handedness), protocols::word_of(protocol.language));
    say("{} of which {} pictured, {}\n", counted(protocol.objects.size(), "object"),
        objects_of(protocol, true).size(), counted(protocol.frictions.size(), "friction"));
    say("{}: {} practice, {} main in {}, {} catch\n", counted(plan.trials.size(), "trial"),
        trials_of(plan, Phase::practice), trials_of(plan, Phase::main),
        counted(block_count(protocol), "block"), trials_of(plan, Phase::catch_trial));
    if (protocol.masking.noise != protocols::Noise::none) {
        say("masking noise: {} at {:g} dB re full scale\n",
            protocols::word_of(protocol.masking.noise), protocol.masking.level_db);
    }
}

/// What nobody reads twice.
void print_tables(const Protocol& protocol, const Plan& plan) {
    const protocols::PlanSummary summary = summarise(plan);
    if (protocol.procedure) {
        say("\n{}", rule_text(protocol, plan));
        return;
    }
    say("\n{}\nin the order of a participant named {}, other orders differ:\n{}\n{}",
        counts_text(protocol, summary), kExample, limits_text(protocol, plan, summary),
        steps_text(protocol, summary));
}

/// @return whether it can be run
bool print_feasibility(const Study& study,
                       const protocols::SessionKey& key,
                       const CheckOptions& options) {
    RigSpec spec;
    spec.study = study;
    spec.key = key;
    spec.seed = study.protocol.seed;
    spec.device = parse_device(options.device);
    spec.rig = rig_file_of(spec.device, options.calibration);
    const std::string unproved = objection(spec.rig, options.device, options.calibration);
    spec.rig.record.reset();  // nobody is asked to prove it
    spec.recordings = load_recordings(spec.device);
    OpenedApparatus opened = open_apparatus(spec);
    if (!unproved.empty()) {
        opened.findings.insert(opened.findings.begin(),
                               {protocols::Verdict::warn, "no real session: " + unproved});
    }
    say("\non {}", opened.port->device_name());
    const bool refused = std::ranges::count(opened.findings, protocols::Verdict::refuse,
                                            &protocols::Finding::verdict) > 0;
    say(": {}\n", refused                   ? "it cannot be run"
                  : opened.findings.empty() ? "nothing stands against it"
                  : !unproved.empty()       ? "it can be run as a pilot, and this should be known"
                                            : "it can be run, and this should be known");
    for (const protocols::Finding& finding : opened.findings) {
        say("  {}: {}\n", finding.verdict == protocols::Verdict::refuse ? "refused" : "warning",
            finding.text);
    }
    if (!opened.rest.empty()) {
        say("  rest: {}\n", opened.rest);
    }
    say("{}", softness_text(study.protocol));
    return !refused;
}

void declare(CommandWords& words, CheckOptions& options) {
    words.add("PROTOCOL", options.protocol, "A protocol file, or the name of a shipped one")
        .required();
    words.add("--device", options.device, std::string(kDeviceWords));
    words.add("--calibration", options.calibration, std::string(kCalibrationWords));
    words.add("--font", options.font,
              "A TrueType font for the subject's screen: does it have all letters?");
    words.add("--svg", options.svg, "Draw the objects into this file");
    words.add("--long", options.tables,
              "The tables as well: trials of each condition, limits, what follows what");
}

int run(const CheckOptions& options) {
    const Study study = load_study(options.protocol);
    const protocols::SessionKey key{kExample, 1};
    const Plan plan = make_plan(study.protocol, study.hash, key, study.protocol.seed);
    if (!options.svg.empty()) {
        write_whole(options.svg, data::object_sheet(study.protocol, study.hash));
    }
    print_title(study);
    print_duration(study.protocol, plan);
    print_advice(study.protocol, plan, options);
    const bool feasible = print_feasibility(study, key, options);
    print_design(study, plan);
    if (options.tables) {
        print_tables(study.protocol, plan);
    } else {
        say("Trials of each condition, limits, what follows what: --long\n");
    }
    if (!options.svg.empty()) {
        say("objects drawn in {}\n", options.svg);
    }
    return feasible ? 0 : kExitFailure;
}

}  // namespace

Command check_command() {
    return make_command<CheckOptions>(
        "check", "Is this protocol right, how long does it take, and can this device render it?",
        declare, run);
}

}  // namespace palpate::ui
