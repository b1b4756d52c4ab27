#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/clock.hpp"
#include "engine/device/drivers/guard_process.hpp"
#include "protocols/session/feasibility.hpp"
#include "ui/doctor/checks.hpp"

namespace palpate::ui {
namespace {

using engine::JointAngles;
using engine::Vec2;

constexpr int kReadings = 200;
constexpr std::int64_t kReadingNs = 1'000'000;

struct Readings {
    int good = 0;
    int fresh = 0;
    engine::Reading last{};
    double slowest_us = 0.0;  ///< of a read and a write together
};

Readings read_for_a_while(engine::Device& device) {
    Readings readings;
    std::int64_t due = monotonic_ns();
    for (int i = 0; i < kReadings; ++i) {
        const std::int64_t before = monotonic_ns();
        readings.last = device.read();
        device.write(engine::Vec3{});
        const auto took = static_cast<double>(monotonic_ns() - before) * 1e-3;
        readings.slowest_us = std::max(readings.slowest_us, took);
        readings.good += readings.last.ok() ? 1 : 0;
        readings.fresh += readings.last.ok() && readings.last.fresh ? 1 : 0;
        due += kReadingNs;
        sleep_until(due);
    }
    return readings;
}

/// Adds to `check` what a board's answers were like, as they were measured when it was opened.
void tell_answers(Check& check, const Readings& readings, const engine::DeviceTraits& traits) {
    if (readings.good == kReadings && readings.fresh == 0) {
        check.fails(
            "its answers come so late that no reading was new: check the cable, and use a port of "
            "the computer itself");
        return;
    }
    check.detail +=
        fmt::format("; {} new, answers after {:.2f} ms", readings.fresh, 1e3 * traits.round_trip);
    check.detail +=
        std::isinf(traits.holds_force)
            ? "; no watchdog of its own"
            : fmt::format("; its own watchdog stops it after {:g} ms", 1e3 * traits.holds_force);
    // With a watchdog of the board's own it matters less.
    check.detail += engine::GuardProcess({.apart = true}).apart()
                      ? "; its guard has a control group of its own"
                      : "; its guard shares palpate's control group, and is frozen with it";
    check.numbers.emplace_back("answer_ms", 1e3 * traits.round_trip);
    check.numbers.emplace_back("delay_ticks", traits.delay_ticks);
    if (traits.delay_ticks > 1.0) {
        check.detail += fmt::format(
            "; its force follows the handle {:g} ticks later, which takes a softer object: see "
            "passivity",
            traits.delay_ticks);
    }
}

/// Worst errors over a workspace.
struct Worst {
    int places = 0;
    double distance = 0.0;  ///< of forward(inverse(p)) from p, m
    double jacobian =
        0.0;  ///< of the Jacobian from central differences, relative to its largest entry
};

/// Central difference of the handle by joint `joint`; none where a pose is missing.
std::optional<Vec2> slope(const engine::FiveBar& bars,
                          const JointAngles& angles,
                          std::size_t joint) {
    constexpr double kStep = 1e-5;  // rad: cuts off 1e-10 of the slope, rounds off 1e-11
    JointAngles more = angles;
    JointAngles less = angles;
    more[joint] += kStep;
    less[joint] -= kStep;
    const auto ahead = bars.forward(more);
    const auto behind = bars.forward(less);
    if (!ahead || !behind) {
        return std::nullopt;
    }
    return (ahead->handle - behind->handle) / (more[joint] - less[joint]);
}

void look_at(const engine::FiveBar& bars, const Vec2& place, Worst& worst) {
    const auto angles = bars.inverse(place);
    const auto pose = angles ? bars.forward(*angles) : std::nullopt;
    const auto jacobian = pose ? bars.jacobian(*pose) : std::nullopt;
    const auto by_1 = jacobian ? slope(bars, *angles, 0) : std::nullopt;
    const auto by_2 = jacobian ? slope(bars, *angles, 1) : std::nullopt;
    if (!by_1 || !by_2) {
        return;  // outside the reach
    }
    ++worst.places;
    worst.distance = std::max(worst.distance, glm::length(pose->handle - place));
    const Vec2 off_1 = Vec2{jacobian->row_x.x, jacobian->row_y.x} - *by_1;
    const Vec2 off_2 = Vec2{jacobian->row_x.y, jacobian->row_y.y} - *by_2;
    const double size = std::max(glm::length(*by_1), glm::length(*by_2));
    worst.jacobian =
        std::max(worst.jacobian, std::max(glm::length(off_1), glm::length(off_2)) / size);
}

Worst worst_of(const Linkage& linkage) {
    constexpr int kSteps = 20;
    Worst worst;
    for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; j <= kSteps; ++j) {
            const Vec2 share{2.0 * i / kSteps - 1.0, 2.0 * j / kSteps - 1.0};
            look_at(linkage.bars, linkage.centre + share * linkage.half, worst);
        }
    }
    return worst;
}

void say_readings(Check& check, const std::string& of, const Readings& readings, bool in_space) {
    check.detail = fmt::format(
        "{}: {} of {} readings good, slowest {:.0f} us, handle at ({:.1f}, {:.1f}{}) mm", of,
        readings.good, kReadings, readings.slowest_us, 1e3 * readings.last.hip.x,
        1e3 * readings.last.hip.y,
        in_space ? fmt::format(", {:.1f}", 1e3 * readings.last.hip.z) : std::string());
    check.numbers = {{"readings", kReadings},
                     {"good", readings.good},
                     {"fresh", readings.fresh},
                     {"slowest_us", readings.slowest_us},
                     {"x_mm", 1e3 * readings.last.hip.x},
                     {"y_mm", 1e3 * readings.last.hip.y}};
    if (in_space) {
        check.numbers.emplace_back("z_mm", 1e3 * readings.last.hip.z);
    }
}

void say_force(Check& check, bool gives_force, const std::optional<double>& weakest) {
    check.detail += gives_force ? "" : "; it gives no force";
    if (weakest) {
        check.detail += fmt::format("; at least {:.1f} N at the start", *weakest);
        check.numbers.emplace_back("weakest_force_n", *weakest);
    }
}

void say_margins(Check& check,
                 const protocols::ApparatusSpec& asked,
                 const protocols::Margins& margins) {
    check.detail =
        fmt::format("{:.6g} N/m at {:.6g} Hz needs {:.3g} N s/m, the device damps {}",
                    asked.stiffness, asked.rate_hz, margins.needed_damping,
                    margins.damping ? fmt::format("{:.3g} ({:.2f} times as much)", *margins.damping,
                                                  *margins.damping / margins.needed_damping)
                                    : std::string("by what nobody measured"));
    check.numbers = {{"needed_damping_n_s_per_m", margins.needed_damping},
                     {"force_limit_n", asked.force_limit}};
    if (margins.damping) {
        check.numbers.emplace_back("damping_n_s_per_m", *margins.damping);
    }
    if (margins.weakest_force) {
        check.detail +=
            fmt::format("; up to {:.3g} N are asked for, it gives {:.3g} N or more on every object",
                        asked.force_limit, *margins.weakest_force);
        check.numbers.emplace_back("weakest_force_n", *margins.weakest_force);
    }
    if (const std::string rest = protocols::rest_text(margins); !rest.empty()) {
        check.detail += "; " + rest;
        check.numbers.emplace_back("reading_error_m", *margins.reading_error);
        check.numbers.emplace_back("resting_friction_n", margins.resting_friction);
    }
}

}  // namespace

Check check_device(const std::string& word,
                   const OpenDevice& open,
                   const engine::Vec3& start,
                   const LookAgain& then) {
    Check check{.name = "device", .detail = word};
    std::shared_ptr<engine::Device> device;
    try {
        device = open();
    } catch (const std::exception& e) {
        check.fails(e.what());
        return check;
    }
    device->write(engine::Vec3{});
    const Readings readings = read_for_a_while(*device);
    const engine::DeviceTraits traits = device->traits();
    device->write(engine::Vec3{});
    say_readings(check, word + " (" + device->name() + ')', readings, traits.axes > 2);
    say_force(check, traits.gives_force, device->weakest_force(start));
    if (readings.good < kReadings) {
        const std::string trouble = device->trouble();
        check.fails(!trouble.empty()
                        ? trouble
                        : "check its cable and power, and that the handle is in the workspace");
    }
    if (traits.round_trip > 0.0) {
        tell_answers(check, readings, traits);
    }
    if (then && readings.good > 0) {
        then(*device);
    }
    return check;
}

Check check_feasible(const protocols::Protocol& protocol, const engine::Device& device) {
    Check check{.name = "passivity and force"};
    const protocols::ApparatusSpec& asked = protocol.apparatus;
    const protocols::Margins margins = protocols::margins_of(protocol, device);
    if (!device.traits().gives_force) {
        check.detail = "the device gives no force: nothing to check";
        return check;
    }
    say_margins(check, asked, margins);
    for (const protocols::Finding& finding : protocols::check_feasibility(protocol, device)) {
        const bool refused = finding.verdict == protocols::Verdict::refuse;
        check.status = std::max(check.status, refused ? CheckStatus::fail : CheckStatus::warn);
        check.remedy += (check.remedy.empty() ? "" : "; ") + finding.text;
    }
    return check;
}

Check check_kinematics(std::span<const Linkage> linkages) {
    constexpr double kDistance = 1e-9;  // m: a thousandth of an encoder count at the handle
    constexpr double kJacobian = 1e-6;
    Check check{.name = "kinematics"};
    Worst all;
    for (const Linkage& linkage : linkages) {
        const Worst worst = worst_of(linkage);
        check.detail += (check.detail.empty() ? "" : ", ") + linkage.name;
        all.places += worst.places;
        all.distance = std::max(all.distance, worst.distance);
        all.jacobian = std::max(all.jacobian, worst.jacobian);
        check.numbers.emplace_back(linkage.name + "_places", worst.places);
        check.numbers.emplace_back(linkage.name + "_round_trip_m", worst.distance);
        check.numbers.emplace_back(linkage.name + "_jacobian_error", worst.jacobian);
        if (worst.places == 0 || !(worst.distance <= kDistance) || !(worst.jacobian <= kJacobian)) {
            check.fails("check the link lengths and the origin of " + linkage.name +
                        " in the calibration file");
        }
    }
    check.detail += fmt::format(
        ": {} places, round trip within {:.1e} m, Jacobian within {:.1e} of differences",
        all.places, all.distance, all.jacobian);
    return check;
}

}  // namespace palpate::ui
