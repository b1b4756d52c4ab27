#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/deformation_file.hpp"
#include "protocols/file/document.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

using engine::Vec2;

struct DeformOptions {
    std::string file;
    std::string times;   ///< "0.1,0.2"
    std::string output;  ///< empty: standard output
};

/// More steps than this are a mistake.
constexpr double kMaxSteps = 1e8;

/// Rising times from 0, s. @throws std::invalid_argument with the value and the remedy
std::vector<double> times_of(const std::string& text, double step) {
    std::vector<double> times;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t to = std::min(text.find(',', from), text.size());
        const std::string word = text.substr(from, to - from);
        const double time = parsed<double>(word).value_or(-1.0);
        refuse_if(!std::isfinite(time) || time < 0.0 || (!times.empty() && time <= times.back()),
                  "--times has \"{}\": give seconds from 0, each more than the one before, as "
                  "0.1,0.2",
                  word);
        refuse_if(
            time / step > kMaxSteps,
            "--times has {} s, which are more than {:g} steps of {} s: give less, or a larger dt_s",
            time, kMaxSteps, step);
        times.push_back(time);
        from = to + 1;
    }
    return times;
}

std::string head_of(std::size_t points) {
    std::string head = "t_s";
    for (std::size_t i = 0; i < points; ++i) {
        head += fmt::format(",dx{0}_m,dy{0}_m", i);
    }
    for (std::size_t i = 0; i < points; ++i) {
        head += fmt::format(",vx{0}_m_per_s,vy{0}_m_per_s", i);
    }
    return head + ",cx_m,cy_m\n";
}

std::string row_of(double time,
                   const std::vector<Vec2>& displacements,
                   const std::vector<Vec2>& velocities,
                   const Vec2& loaded) {
    std::string row = fmt::format("{}", time);
    for (const std::vector<Vec2>* all : {&displacements, &velocities}) {
        for (const Vec2& one : *all) {
            row += fmt::format(",{},{}", one.x, one.y);
        }
    }
    return row + fmt::format(",{},{}\n", loaded.x, loaded.y);
}

/// Within a step the acceleration is constant: that is what the trapezoid rule says.
std::string motion_csv(const protocols::DeformationCase& c, const std::vector<double>& times) {
    engine::DnurbsMotion motion(c.curve, c.step);
    const engine::BasisAt where = c.curve.basis(c.at_u);
    std::string text = head_of(c.curve.points());
    std::vector<Vec2> q = motion.displacements();
    std::vector<Vec2> v = motion.velocities();
    double begin = 0.0;  // of the last step
    std::int64_t steps = 0;
    for (const double time : times) {
        while (static_cast<double>(steps) * c.step < time) {
            q = motion.displacements();
            v = motion.velocities();
            begin = static_cast<double>(steps) * c.step;
            motion.advance(where, c.force);
            ++steps;
        }
        const double share = steps == 0 ? 0.0 : (time - begin) / c.step;
        std::vector<Vec2> shown_q = motion.displacements();
        std::vector<Vec2> shown_v = motion.velocities();
        if (share < 1.0 - 1e-9) {
            for (std::size_t i = 0; i < q.size(); ++i) {
                const Vec2 gained = share * (shown_v[i] - v[i]);
                shown_q[i] = q[i] + share * c.step * (v[i] + 0.5 * gained);
                shown_v[i] = v[i] + gained;
            }
        }
        text += row_of(time, shown_q, shown_v, c.curve.point(c.at_u, shown_q));
    }
    return text;
}

std::string rest_csv(const protocols::DeformationCase& c) {
    const std::vector<Vec2> q = c.curve.equilibrium(c.at_u, c.force);
    return head_of(c.curve.points()) + row_of(std::numeric_limits<double>::infinity(), q,
                                              std::vector<Vec2>(q.size()),
                                              c.curve.point(c.at_u, q));
}

/// A step beyond the motion skips it: the trapezoid rule does not damp what it cannot follow.
void warn_of_step(const DeformOptions& options, const protocols::DeformationCase& c) {
    const double omega = c.curve.spec().mu > 0.0 ? c.curve.slowest_motion() : 0.0;
    if (c.step * omega > 1.0) {
        warn(
            "{}: dt_s is {} s, and the curve's slowest motion has 1/omega = {:.3g} s: what is "
            "shown is not its motion; give a dt_s well below that",
            options.file, c.step, 1.0 / omega);
    }
}

int deform(const DeformOptions& options) {
    const protocols::DeformationCase c = protocols::parse_deformation(
        protocols::read_text(options.file, protocols::kMaxDocument), options.file);
    refuse_if(c.at_rest != options.times.empty(), "{}",
              c.at_rest ? "--times is given, but the case is static: leave out one of them"
                        : "the case is a motion: give --times 0.1,0.2 in seconds, or static = true "
                          "in the case");
    if (!c.at_rest) {
        warn_of_step(options, c);
    }
    write_whole(options.output,
                c.at_rest ? rest_csv(c) : motion_csv(c, times_of(options.times, c.step)));
    return 0;
}

}  // namespace

Command deform_command() {
    return make_command<DeformOptions>(
        "deform", "Deform a NURBS curve by a force: control points over time, or at rest",
        [](CommandWords& words, DeformOptions& options) {
            words.add("CASE", options.file, "A curve, what it is made of, and the force (TOML)")
                .required();
            words.add("--times", options.times, "Seconds at which to show a motion: 0.1,0.2");
            words.add("-o,--output", options.output, "Where to write; standard output without it");
        },
        deform);
}

}  // namespace palpate::ui
