#include "engine/commissioning/short_form.hpp"

#include <cmath>

#include "engine/base/text.hpp"
#include "engine/commissioning/handle_fit.hpp"
#include "engine/commissioning/pulse_match.hpp"
#include "engine/commissioning/straight_axes.hpp"
#include "engine/device/machine.hpp"

namespace palpate::engine {
namespace {

/// A motor may have become so much stronger or weaker since: less than what a hand would notice as
/// another stiffness, more than pulses of whole counts leave open.
constexpr double kMaxGainChange = 0.2;

AxesChange change_of(const Calibration& machine,
                     std::span<const Pulse> pulses,
                     const RigRecord& record,
                     double delay) {
    if (machine.gantry) {
        return change_of_axes(Gantry(*machine.gantry), pulses, record.axes, delay);
    }
    const Pantograph linkage(machine.pantograph);
    std::vector<Track> tracks;
    for (const Pulse& pulse : pulses) {
        tracks.push_back(track_of(linkage, pulse, false, {1.0, 1.0}, delay));
    }
    const HandleChange change = fit_change(tracks, record.dynamics);
    return {.gain = {change.gain, 1.0}, .late = change.late, .unexplained = change.unexplained};
}

std::string changed_text(const Vec3& gains, std::size_t axes) {
    std::string text;
    bool stronger = false;
    for (std::size_t i = 0; i < axes; ++i) {
        const double gain = gains[static_cast<int>(i)];
        if (!(std::fabs(gain - 1.0) <= kMaxGainChange)) {
            stronger = stronger || gain > 1.0;
            text += (text.empty() ? "motor " : ", motor ") +
                    (axes > 2 ? std::string(1, "xyz"[i]) : std::to_string(i + 1)) + " gives " +
                    number_text(std::round(100.0 * gain) / 100.0) + " times what it did";
        }
    }
    return text.empty() ? text
         : stronger     ? text + ": a motor is too strong, or the handle is lighter than it was"
                        : text +
                          ": is somebody holding it, does something block it, or is a "
                          "wire of the motor loose or its supply weak";
}

}  // namespace

ShortForm prove_again(PulseRunner& runner,
                      const Calibration& machine,
                      const RigRecord& record,
                      double delay) {
    ShortForm form;
    const Machine whole(machine);
    const Vec3 mass(record.axes[0].mass, record.axes[1].mass, record.axes[2].mass);
    std::vector<Pulse> pulses;
    for (const Vec3& direction : pulse_directions(machine.axes())) {
        pulses.push_back(
            runner.give(direction, pulse_plan(machine, direction, record.force, mass)));
        const Pulse& pulse = pulses.back();
        form.refused = wrong_with(whole, pulse, record, delay);
        if (!form.refused.empty()) {
            return form;
        }
        const PulseMatch found = match(whole, pulse, record, delay);
        form.found += (form.found.empty() ? "" : ", ") +
                      number_text(std::round(100.0 * found.share)) + " % at " +
                      number_text(std::round(found.angle * 180.0 / kPi)) + " deg";
    }
    const AxesChange change = change_of(machine, pulses, record, delay);
    form.found += ", seen " + number_text(std::round(1e4 * change.late) / 10.0) + " ms late";
    form.refused = unexplained_by_motion(change.unexplained, change.late);
    form.refused = form.refused.empty() ? changed_text(change.gain, machine.axes()) : form.refused;
    return form;
}

}  // namespace palpate::engine
