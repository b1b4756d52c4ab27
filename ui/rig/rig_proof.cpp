#include "ui/rig/rig_proof.hpp"

#include <cerrno>
#include <cmath>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/refuse.hpp"
#include "engine/commissioning/place_proof.hpp"
#include "engine/commissioning/short_form.hpp"
#include "engine/realtime/realtime_rights.hpp"
#include "protocols/session/trust.hpp"
#include "ui/rig/device_choice.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

constexpr double kRest = 1.0;     ///< s that the handle has to rest
constexpr double kOffHome = 2.0;  ///< counts between set-up and now

/// A file that `palpate commission` makes, or writes over: rig.toml, or rig_2.toml beside another
/// device's.
std::string name_for(const std::string& device) {
    for (int number = 1;; ++number) {
        std::string name = number == 1 ? "rig.toml" : fmt::format("rig_{}.toml", number);
        const auto there = record_in(name);
        if (std::error_code unknown;
            there ? there->device == device : !std::filesystem::exists(name, unknown)) {
            return name;
        }
    }
}

std::string commission_words(const std::string& device,
                             const std::string& calibration,
                             bool straight,
                             const std::string& output) {
    return "palpate commission --device " + shell_word(device) +
           (calibration.empty() ? std::string() : " --calibration " + shell_word(calibration)) +
           (straight ? " --moved-g X_G,Y_G,Z_G -o " : " -o ") + output;
}

/// A line of standard input, byte by byte: a signal that asks to stop ends it while nobody types,
/// and so does Escape. @return none: it ended, or the program is to stop
std::optional<std::string> typed_line() {
    constexpr int kLookMs = 100;
    std::string line;
    while (!interrupted()) {
        pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
        if (poll(&input, 1, kLookMs) <= 0) {
            continue;
        }
        char byte = 0;
        const ssize_t got = read(STDIN_FILENO, &byte, 1);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return line.empty() ? std::nullopt : std::optional(line);
        }
        if (got > 0 && byte == '\n') {
            return line;
        }
        if (got > 0 && byte == kEscapeByte) {
            interrupt();
        }
        line.append(got > 0 ? 1 : 0, byte);
    }
    return std::nullopt;
}

/// The handle did not move since the device took its pose for home.
void prove_rest(engine::PulseRunner& runner, const engine::Calibration& calibration) {
    const engine::Rest rest = runner.watch(kRest);
    refuse_if<std::runtime_error>(!std::isfinite(rest.place.x),
                                  "the device said nothing new for a second: check its cable");
    refuse_if<std::runtime_error>(
        rest.span.x > engine::kStillCounts || rest.span.y > engine::kStillCounts ||
            rest.span.z > engine::kStillCounts,
        "the handle moves: let it rest, free, at home, and run the same command again");
    if (!engine::starts_at_home(calibration)) {
        return;  // its counts are its own: where it rests is known by them alone
    }
    const engine::Machine::Counts home = engine::Machine(calibration).home();
    const engine::Vec3 off = glm::abs(rest.counts - engine::Vec3(home[0], home[1], home[2]));
    refuse_if<std::runtime_error>(
        off.x > kOffHome || off.y > kOffHome || off.z > kOffHome,
        "the handle moved while the device was opened, so that its home is lost: let it rest, "
        "free, at home, and run the same command again");
}

/// What was found of a rig when it was opened.
protocols::Event opening_fact(std::string_view key, std::string value, std::string text) {
    return {.kind = protocols::EventKind::provenance,
            .text = std::move(text),
            .key = std::string(key),
            .value = std::move(value)};
}

protocols::Event prove_mark(engine::PulseRunner& runner,
                            const engine::Calibration& calibration,
                            const engine::Vec3& mark) {
    const std::string aim = engine::place_text(mark, calibration.axes());
    if (!typed_after(fmt::format(
            "Bring the handle to the second mark {}, let go of it and press Enter. ", aim))) {
        throw std::runtime_error(
            interrupted() ? "stopped before the second mark was tried; no session was begun"
                          : "standard input ended before the second mark was tried: --handle-free "
                            "gives your word instead");
    }
    const engine::Sight seen = engine::look_for(runner, calibration, mark);
    const engine::Vec3 home = engine::home_of(calibration);
    refuse_if<std::runtime_error>(
        seen.place && glm::length(*seen.place - home) <= engine::kAtPlace,
        "the encoders say that the handle is still at home, {}: run the same command again, and "
        "bring it to the second mark {} before you press Enter",
        engine::place_text(home, calibration.axes()), aim);
    refuse_if<std::runtime_error>(
        !seen.there(),
        "the handle is at the second mark {}, and the encoders say {}: it did not rest at home {} "
        "when the device was opened, or its plugs were exchanged. Put it there and run the same "
        "command again; if it was there, commission the rig anew",
        aim, seen.text(calibration.axes()), engine::place_text(home, calibration.axes()));
    return opening_fact(
        protocols::kStartPose, fmt::format("second mark met to {:.1f} mm", 1e3 * seen.off),
        fmt::format("the handle rested at home; the second mark {} was met to {:.1f} mm", aim,
                    1e3 * seen.off));
}

/// Gives a step of a proof its runner, on a thread that is woken in time.
using Look = std::function<engine::ShortForm(engine::PulseRunner&, engine::Device&)>;
protocols::RigProof::Step step_of(const engine::Calibration& calibration,
                                  double period,
                                  const std::function<bool()>& stopped,
                                  Look look) {
    return [calibration, period, stopped, look = std::move(look)](engine::Device& device) {
        engine::ShortForm form;
        try {
            in_real_time([&] {
                engine::PulseRunner runner(device, engine::Machine(calibration), period,
                                           ticks_until(period, stopped));
                form = look(runner, device);
            });
        } catch (const StopDuringPulses&) {
            form = {.refused = "no force is wanted, so that the rig was not proved", .found = {}};
        }
        return form;
    };
}

}  // namespace

std::optional<engine::RigRecord> record_in(const std::string& file) {
    try {
        return std::filesystem::exists(file) ? protocols::load_rig(file, true).record
                                             : std::nullopt;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

std::string objection(const protocols::RigFile& rig,
                      const std::string& device,
                      const std::string& calibration) {
    if (!pushes_a_person(parse_device(device).kind)) {
        return {};
    }
    const auto& record = rig.record;
    const std::string output = name_for(device);
    const std::string words =
        commission_words(device, calibration, rig.calibration.gantry.has_value(), output);
    if (!record) {
        return fmt::format(
            "nobody proved how --device {} is wired and how strong it is: {} does, in two minutes "
            "with the handle free; then give --calibration {}",
            device, words, output);
    }
    if (record->device != device) {
        return fmt::format("--calibration {} was commissioned for --device {}, and this is {}: {}",
                           calibration, record->device, device, words);
    }
    if (record->calibration != protocols::calibration_id(rig.calibration)) {
        return fmt::format("the calibration in {} was changed after the rig was commissioned: {}",
                           calibration, words);
    }
    if (record->program != PALPATE_VERSION) {
        return fmt::format("{} was commissioned by palpate {}, and this is {}: {}", calibration,
                           record->program, PALPATE_VERSION, words);
    }
    return {};
}

std::optional<std::string> typed_after(const std::string& question) {
    const TypedAnswer answering;  // before anybody can answer
    say("{}", question);
    return typed_line();
}

void in_real_time(const std::function<void()>& work) {
    std::exception_ptr thrown;
    std::thread thread([&] {
        engine::RealtimeRights rights;
        engine::take_thread_rights({.memory = false, .latency = false}, rights);
        try {
            work();
        } catch (...) {
            thrown = std::current_exception();
        }
    });
    thread.join();
    if (thrown) {
        std::rethrow_exception(thrown);
    }
}

engine::PulseRunner::Wait ticks_until(double period, std::function<bool()> stopped) {
    constexpr std::int64_t kFarBehind = 20'000'000;
    const auto step = static_cast<std::int64_t>(period * 1e9 + 0.5);
    return [step, due = std::int64_t{0}, stopped = std::move(stopped)]() mutable {
        if (stopped()) {
            throw StopDuringPulses{};
        }
        due += step;
        const std::int64_t now = monotonic_ns();
        const bool behind = now - due >= step;
        if (now - due > kFarBehind) {
            due = now;
        }
        sleep_until(due);
        return !behind && monotonic_ns() - due < step;
    };
}

protocols::Event moves_as_it_did(const engine::ShortForm& form) {
    refuse_if<std::runtime_error>(
        !form.refused.empty(),
        "{}. No session was begun; if nobody held the handle, commission the rig again",
        form.refused);
    return opening_fact(protocols::kRigCheck, form.found,
                        fmt::format("{}: {}", protocols::kHandleMoves, form.found));
}

std::unique_ptr<StopLines> stops_of_pulses(std::shared_ptr<StopButton> button) {
    return std::make_unique<StopLines>(
        "", "weak pulses that prove a rig\n", std::move(button),
        StopLines::Acts{.stop = [](const char*) { interrupt(); }, .pipes = false});
}

void check_board(const engine::Device& device, const engine::RigRecord& record) {
    const auto said = [](std::optional<std::uint32_t> id) {
        return id ? fmt::format("the board with the id {}", *id)
                  : std::string("a device that says no id");
    };
    const auto now = engine::board_id(device.identity());
    refuse_if<std::runtime_error>(
        now != record.board,
        "{} was commissioned with {}, and this is {}: plug that one in, or commission this one. No "
        "session was begun",
        device.name(), said(record.board), said(now));
}

void ask_for_home(const engine::Calibration& calibration, bool beforehand) {
    const std::string text = fmt::format(
        "Nobody may hold the handle now: weak pulses will move it by some mm, and Escape here "
        "stops "
        "them. {} Type yes: ",
        engine::starts_at_home(calibration)
            ? fmt::format("It has to rest at home, {}.",
                          engine::place_text(engine::home_of(calibration), calibration.axes()))
            : std::string("Let it rest in the middle of the workspace."));
    for (std::optional<std::string> line; !beforehand && line != "yes" && line != "y";) {
        line = typed_after(text);
        refuse_if<std::runtime_error>(
            !line, "{}",
            interrupted() ? "stopped at the question; nothing was begun"
                          : "standard input ended, and nobody said that the handle is free and "
                            "at home: --handle-free says so beforehand");
    }
}

std::vector<protocols::Event> prove_opening(engine::Device& device,
                                            const engine::Calibration& calibration,
                                            const engine::RigRecord& record,
                                            double period,
                                            bool beforehand,
                                            std::shared_ptr<StopButton> button) {
    std::vector<protocols::Event> facts;
    const auto stops = stops_of_pulses(std::move(button));
    const auto prove = [&] {
        engine::PulseRunner runner(device, engine::Machine(calibration), period,
                                   ticks_until(period, interrupted));
        const std::size_t homings = device.homings();
        {
            const TypedAnswer early;  // Enter before it is asked for answers the next question
            prove_rest(runner, calibration);
        }
        facts.push_back(record.mark && !beforehand
                            ? prove_mark(runner, calibration, *record.mark)
                            : opening_fact(protocols::kStartPose, "the operator's word",
                                           "the handle rested; that it was at home is the "
                                           "operator's word"));
        const engine::ShortForm form =
            prove_again(runner, calibration, record, device.traits().delay_ticks * period);
        refuse_if<std::runtime_error>(
            device.homings() != homings,
            "the device fell silent while weak pulses moved the handle, and was set up anew where "
            "it stood: its home is lost, and nothing is said of its motors. Check its cable and "
            "what else this machine does, put the handle at home and run the same command again");
        facts.push_back(moves_as_it_did(form));
    };
    try {
        in_real_time(prove);
    } catch (const StopDuringPulses&) {
        throw std::runtime_error(
            "stopped while the rig was proved: its motors are off, no session was begun");
    }
    return facts;
}

protocols::RigProof proof_between_trials(const engine::Calibration& calibration,
                                         const engine::RigRecord& record,
                                         double period,
                                         const std::function<bool()>& stopped) {
    const auto motors = [calibration, record, period](engine::PulseRunner& runner,
                                                      engine::Device& device) {
        engine::ShortForm form =
            prove_again(runner, calibration, record, device.traits().delay_ticks * period);
        if (!form.refused.empty()) {
            form.refused =
                "weak pulses try the handle again and again, and nobody may hold it until "
                "they are right: " +
                form.refused;
        }
        return form;
    };
    const Look home = [calibration](engine::PulseRunner& runner, engine::Device&) {
        return prove_home(runner, calibration);
    };
    Look mark = [](engine::PulseRunner&, engine::Device&) -> engine::ShortForm {
        return {.refused = {}, .found = "the experimenter's word: there is no second mark"};
    };
    if (record.mark) {
        mark = [proof = engine::MarkProof(calibration, *record.mark)](
                   engine::PulseRunner& runner, engine::Device& device) mutable {
            return proof.look(runner, device);
        };
    }
    return {.home = step_of(calibration, period, stopped, home),
            .mark = step_of(calibration, period, stopped, std::move(mark)),
            .motors = step_of(calibration, period, stopped, motors)};
}

}  // namespace palpate::ui
