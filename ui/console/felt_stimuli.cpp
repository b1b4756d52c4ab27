#include "ui/console/felt_stimuli.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/refuse.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"
#include "ui/rig/stop_lines.hpp"
#include "ui/session/run_rig.hpp"

namespace palpate::ui {
namespace {

using protocols::Presentation;

const protocols::FrictionSpec& friction_named(const protocols::Protocol& protocol,
                                              const std::string& name) {
    return *std::ranges::find(protocol.frictions, name, &protocols::FrictionSpec::name);
}

/// What the rule of a protocol may choose: its ends, and what is between them.
std::vector<FeltStimulus> rule_stimuli(const protocols::Protocol& protocol) {
    const protocols::AdaptiveSpec& rule = *protocol.procedure;
    std::vector<FeltStimulus> all;
    for (const protocols::RunSpec& run : protocol.runs) {
        const Presentation standard{
            .object =
                *std::ranges::find(protocol.objects, rule.object, &protocols::ObjectSpec::name),
            .friction = friction_named(
                protocol, run.standard_friction.empty() ? run.friction : run.standard_friction)};
        all.emplace_back(run.name + ", standard", standard);
        for (const double share : {0.0, 0.5, 1.0}) {
            const double chosen = rule.lowest + share * (rule.highest - rule.lowest);
            if (std::isfinite(chosen)) {
                Presentation one = standard;
                one.friction = friction_named(protocol, run.friction);
                feel_stimulus(rule, chosen, one);
                all.emplace_back(
                    fmt::format("{}, {} {:.4g}", run.name, protocols::word_of(rule.varies),
                                felt_value(rule, chosen)),
                    one);
            }
        }
    }
    return all;
}

std::vector<FeltStimulus> stimuli_of(const protocols::Protocol& protocol) {
    if (protocol.procedure) {
        return rule_stimuli(protocol);
    }
    std::vector<FeltStimulus> all;
    for (const auto& object : protocol.objects) {
        for (const auto& friction : protocol.frictions) {
            all.emplace_back(fmt::format("{}, friction {}", object.name, friction.name),
                             Presentation{.object = object, .friction = friction});
        }
    }
    return all;
}

}  // namespace

FeltStimuli::FeltStimuli(std::string protocol,
                         RigSpec rig,
                         std::string device,
                         const std::string& calibration)
    : protocol_(std::move(protocol)), rig_(std::move(rig)), device_(std::move(device)) {
    using Kind = DeviceChoice::Kind;
    refuse_if(rig_.device.kind == Kind::mouse || rig_.device.kind == Kind::replay,
              "--device {} of a preview: give a device with force, or sim; palpate run has the "
              "window of a pointer, and what was recorded",
              device_);
    rig_.key.participant = "preview";
    rig_.screen.speed = 1.0;
    rig_.kind =
        held_by_a_person(rig_.device.kind) ? data::RunKind::pilot : data::RunKind::simulated;
    check_record(rig_, device_, calibration);
    read_again();
}

std::string FeltStimuli::event() const {
    const std::scoped_lock lock(mutex_);
    data::Json names = data::Json::array();
    for (const FeltStimulus& one : stimuli_) {
        names.push_back(one.first);
    }
    return event_text(
        "felt",
        {{"device", device_}, {"stimuli", names}, {"on", json_or_null(on_)}, {"said", said_}});
}

std::string FeltStimuli::ask(const std::string& line, bool gone) {
    const data::Json asked = object_in(line);
    const data::Json what = asked.value("do", data::Json());
    if (what == "stop") {
        stop_ = true;
        return answer_of(true, "no force");
    }
    const std::scoped_lock lock(mutex_);
    const bool known = what == "feel" && asked.contains("at") && asked["at"].is_number_unsigned() &&
                       asked["at"] < stimuli_.size();
    if (!known || gone || on_ || asked_) {
        return answer_of(false, known ? "one is felt already: stop it first"
                                      : "there is no such stimulus: nothing was done");
    }
    stop_ = false;
    asked_ = asked["at"].get<std::size_t>();
    return answer_of(true, "it is felt until Stop is pressed");
}

void FeltStimuli::read_again() {
    opened_.reset();
    std::vector<FeltStimulus> stimuli;
    try {
        rig_.study = load_study(protocol_);
        stimuli = stimuli_of(rig_.study.protocol);
    } catch (const std::exception&) {  // the page has the problem at its line
    }
    {
        const std::scoped_lock lock(mutex_);
        stimuli_ = std::move(stimuli);
        asked_.reset();
    }
    say_on_page(std::nullopt, "");
}

void FeltStimuli::say_on_page(std::optional<std::size_t> on, std::string text) {
    const std::scoped_lock lock(mutex_);
    on_ = on;
    said_ = std::move(text);
}

void FeltStimuli::feel_asked() {
    std::optional<FeltStimulus> one;
    {
        const std::scoped_lock lock(mutex_);
        if (const auto at = std::exchange(asked_, std::nullopt)) {
            one = stimuli_.at(*at);
            on_ = at;
            said_ = "the device is opened for " + one->first;
        }
    }
    if (!one) {
        return;
    }
    try {
        if (!opened_) {
            refuse_if(
                rig_.study.protocol.safety.dead_man && held_by_a_person(rig_.device.kind),
                "the protocol asks for a dead-man key, which the window of a session has: palpate "
                "run with --kind pilot lets one feel it");
            opened_ = open_and_check(rig_);
        }
        feel(*one);
    } catch (const std::exception& e) {
        opened_.reset();
        say_on_page(std::nullopt, e.what());
    }
}

/// What a session's exploration does, without whatever would be kept.
void FeltStimuli::feel(const FeltStimulus& one) {
    protocols::Apparatus& port = *opened_->port;
    const engine::FeltScene scene = make_felt_scene(rig_.study.protocol, one.second);
    const StopLines lines("", "preview of " + protocol_ + '\n', {},
                          {.stop =
                               [&](const char*) {
                                   stop_ = true;
                                   port.stop();
                               },
                           .types = held_by_a_person(rig_.device.kind)});
    say_on_page(on_, "felt now: " + one.first);
    std::array<engine::TickRecord, 256> ticks{};
    double strongest = 0.0;
    std::size_t felt = 0;
    const auto drain = [&] {
        for (std::size_t n = port.ring().pop(ticks); n > 0; n = port.ring().pop(ticks)) {
            felt += n;
            for (const engine::TickRecord& tick : std::span(ticks).first(n)) {
                strongest = std::max(strongest, glm::length(tick.command));
            }
        }
    };
    port.allow();
    port.hold(true);  // nobody feels a simulated one
    port.begin(scene, {}, 1);
    struct End {
        protocols::Apparatus& port;
        ~End() { port.end(); }
    };
    bool faulted = false;
    {
        const End end{port};
        while (!faulted && !stop_ && !interrupted() && port.elapsed_s() < kLongest &&
               !port.hand_is_done()) {
            faulted = port.advance() == engine::ServoStatus::faulted;
            port.beat();
            drain();
        }
    }
    drain();
    const std::string trouble = port.trouble();
    say_on_page(std::nullopt, !faulted || stop_
                                  ? fmt::format("{}: {} ticks, {:.2f} N at most; nothing was kept",
                                                one.first, felt, strongest)
                              : trouble.empty() ? std::string(explanation(port.trip()))
                                                : trouble);
    if (faulted) {
        opened_.reset();  // whatever it was, it is opened and proved anew
    }
}

}  // namespace palpate::ui
