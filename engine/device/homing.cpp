#include "engine/device/homing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/device/pantograph.hpp"
#include "engine/math/least_squares.hpp"

namespace palpate::engine {
namespace {

constexpr double kMoved = 0.3e-3;  ///< m, and one count, that a resting handle may move
constexpr double kMissed = 1e-3;   ///< m
constexpr double kNarrow = 5e-3;   ///< m, spread of the marks across their line
constexpr double kMaxScale = 0.1;  ///< of counts per turn

std::string text_of(const Vec2& place) {
    return '(' + number_text(place.x * 1e3) + ", " + number_text(place.y * 1e3) + ") mm";
}

/// One mark, ready to be fitted.
struct Target {
    Vec2 counts{};
    Vec2 angles{};  ///< that belong to the place
    Jacobian jacobian{};
};

Target target_of(const Pantograph& machine, const MarkReading& mark) {
    const auto angles = machine.reach(mark.place);
    const auto fix = angles ? machine.locate(*angles) : std::nullopt;
    refuse_if<HomingError>(!fix, "the mark {} is out of the linkage's reach: give a mark within it",
                           text_of(mark.place));
    const auto& axes = machine.spec().axes;
    const double moved =
        (glm::length(fix->jacobian.column_1()) * mark.span.x / axes[0].counts_per_turn +
         glm::length(fix->jacobian.column_2()) * mark.span.y / axes[1].counts_per_turn) *
        kTurn;
    refuse_if<HomingError>(!(moved <= kMoved + machine.quantum(*fix).largest),
                           "the handle moved by {:.9g} mm while it was read at {}: hold it still, "
                           "or put it into a hole",
                           moved * 1e3, text_of(mark.place));
    return {
        .counts = mark.counts, .angles = {(*angles)[0], (*angles)[1]}, .jacobian = fix->jacobian};
}

/// Adds whole turns to the angles of all targets, so that they go with those of the first.
void unwind(std::vector<Target>& targets, const Vec2& per_count) {
    const Target first = targets.front();
    for (Target& target : targets) {
        const Vec2 expected = first.angles + per_count * (target.counts - first.counts);
        for (int i = 0; i < 2; ++i) {
            target.angles[i] += kTurn * std::floor((expected[i] - target.angles[i]) / kTurn + 0.5);
        }
    }
}

/// The spread of the places across the line that fits them best, m: the root of the smaller
/// eigenvalue of their scatter.
double narrowest(std::span<const MarkReading> marks) {
    Vec2 mean{};
    for (const MarkReading& mark : marks) {
        mean += mark.place / static_cast<double>(marks.size());
    }
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (const MarkReading& mark : marks) {
        const Vec2 away = mark.place - mean;
        xx += away.x * away.x;
        xy += away.x * away.y;
        yy += away.y * away.y;
    }
    const double smallest = singular_values({.row_x = {xx, xy}, .row_y = {xy, yy}}).smallest;
    return std::sqrt(smallest / static_cast<double>(marks.size()));
}

/// The zeros, and the changes of the turn of one count: least squares of
/// |J (zero + counts per_count (1 + change) - angles)| over the targets.
LeastSquares::Row fitted(const std::vector<Target>& targets, const Vec2& per_count, bool scale) {
    LeastSquares fit(scale ? 4 : 2);
    for (const Target& target : targets) {
        const Vec2 turned = per_count * target.counts;
        const Vec2 one = target.jacobian.column_1();
        const Vec2 two = target.jacobian.column_2();
        const Vec2 wanted = target.jacobian * (target.angles - turned);
        for (int k = 0; k < 2; ++k) {
            fit.add({one[k], two[k], one[k] * turned.x, two[k] * turned.y}, wanted[k]);
        }
    }
    return fit.solved(0.0);
}

void check_scale(const std::array<Axis, 2>& before, const std::array<Axis, 2>& after) {
    for (std::size_t i = 0; i < 2; ++i) {
        const double share = after[i].counts_per_turn / before[i].counts_per_turn;
        refuse_if<HomingError>(!(std::fabs(share - 1.0) <= kMaxScale),
                               "axis {} would count {:.9g} a turn instead of {:.9g}: check the "
                               "preset and the order of the marks",
                               i + 1, after[i].counts_per_turn, before[i].counts_per_turn);
    }
}

void measure(Homing& homing, const PantographSpec& spec, std::span<const MarkReading> marks) {
    for (const MarkReading& mark : marks) {
        JointAngles angles{};
        for (std::size_t i = 0; i < 2; ++i) {
            const auto axis = static_cast<int>(i);
            angles[i] =
                homing.axes[i].zero + mark.counts[axis] * (kTurn / homing.axes[i].counts_per_turn);
        }
        const auto fix = Pantograph(spec).locate(angles);
        const double missed =
            fix ? glm::length(fix->hip - mark.place) : std::numeric_limits<double>::infinity();
        refuse_if<HomingError>(
            !(missed <= kMissed),
            "with the zeros that fit best the mark {}{}, more than 1 mm: check the marks' places "
            "and order, the preset's lengths and the encoders' directions",
            text_of(mark.place),
            fix ? " is missed by " + number_text(missed * 1e3) + " mm" : " is nowhere");
        homing.residuals.push_back(missed);
        homing.worst = std::fmax(homing.worst, missed);
    }
}

void check_marks(std::span<const MarkReading> marks, bool scale) {
    refuse_if<HomingError>(marks.empty(), "there is no mark: give at least one");
    refuse_if<HomingError>(
        scale && marks.size() < 3,
        "counts per turn need three marks, {} were given: give more, or find the zeros alone",
        marks.size());
    refuse_if<HomingError>(scale && !(narrowest(marks) >= kNarrow),
                           "the marks lie in line or too close together to tell counts per turn: "
                           "spread them over a triangle of 30 mm or more");
}

}  // namespace

void MarkCounts::add(const Pantograph::Counts& counts) noexcept {
    const Vec3 now(counts[0], counts[1], counts[2]);
    sum_ += now;
    min_ = glm::min(min_, now);
    max_ = glm::max(max_, now);
    ++readings_;
}

MarkReading MarkCounts::at(const Vec2& place) const {
    refuse_if(readings_ == 0, "nothing was read at the mark {}", text_of(place));
    return {.place = place, .counts = Vec2(mean()), .span = Vec2(span())};
}

Homing find_home(const PantographSpec& spec, std::span<const MarkReading> marks, bool scale) {
    check_marks(marks, scale);
    PantographSpec found = spec;
    const Pantograph machine(spec);
    const Vec2 per_count{kTurn / spec.axes[0].counts_per_turn,
                         kTurn / spec.axes[1].counts_per_turn};
    std::vector<Target> targets;
    for (const MarkReading& mark : marks) {
        targets.push_back(target_of(machine, mark));
    }
    unwind(targets, per_count);
    const LeastSquares::Row x = fitted(targets, per_count, scale);
    for (std::size_t i = 0; i < 2; ++i) {
        found.axes[i].zero = x[i] - kTurn * std::floor(x[i] / kTurn + 0.5);
        if (scale) {
            found.axes[i].counts_per_turn = spec.axes[i].counts_per_turn / (1.0 + x[i + 2]);
        }
    }
    if (scale) {
        check_scale(spec.axes, found.axes);
    }
    Homing homing;
    homing.axes = found.axes;
    measure(homing, found, marks);
    return homing;
}

Calibration calibrated(const Calibration& before, const Homing& homing) {
    Calibration after = before;
    after.pantograph.axes = homing.axes;
    if (!before.home) {
        return after;
    }
    const Pantograph machine(before.pantograph);
    const Pantograph found(after.pantograph);
    const auto rest = machine.reach(*before.home);
    const auto fix = rest ? found.locate(found.angles(machine.counts(*rest))) : std::nullopt;
    if (!fix) {
        throw HomingError(
            "with the zeros found the handle could not rest where the device is "
            "switched on, home at " +
            text_of(*before.home) + ": check home and the marks");
    }
    after.home = fix->hip;
    return after;
}

}  // namespace palpate::engine
