#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/text.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/keys.hpp"
#include "data/plot/object_sheet.hpp"
#include "ui/cli/plan_text.hpp"
#include "ui/cli/study_advice.hpp"
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
    for (const std::string& sentence : advice_on(protocol, plan, font_of(options), motors)) {
        say("  warning: {}\n", sentence);
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
    words.add("--device", options.device, std::string(kDeviceWords)).with_default();
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
