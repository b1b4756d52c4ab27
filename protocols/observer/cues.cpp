#include "protocols/observer/cues.hpp"

#include <algorithm>
#include <cmath>

#include "engine/math/elementary.hpp"
#include "protocols/design/object_outline.hpp"

namespace palpate::protocols {
namespace {

using engine::Vec2;

constexpr double kMiddle = 0.8;     ///< share of a chord: ends and vertex are felt as corners
constexpr double kSettled = 0.003;  ///< m; after a turn friction still points the old way
constexpr double kSmoothing = 0.2;  ///< per tick: 5 ms, above the quantum of the encoders
constexpr double kMinSpread = 5.0;  ///< sum of squares of x; a tenth of a second of a full stroke

double spread(double n, double x, double x2) {
    return n > 0.0 ? x2 - x * x / n : 0.0;
}

}  // namespace

CurvatureCues::CurvatureCues(const OutlineSpec& outline) {
    const auto chord = [](const Vec2& from, const Vec2& to) {
        const double length = glm::length(to - from);
        const Vec2 along = (to - from) / length;
        return Chord{.middle = 0.5 * (from + to),
                     .along = along,
                     .outward = engine::perp(along),
                     .half = 0.5 * length};
    };
    chords_ = {chord(outline.a, outline.vertex), chord(outline.vertex, outline.b)};
}

void CurvatureCues::add(std::span<const engine::TickRecord> ticks) noexcept {
    for (const engine::TickRecord& tick : ticks) {
        add(tick);
    }
}

std::size_t CurvatureCues::chord_at(const Vec2& hip) const noexcept {
    std::size_t nearest = kNone;
    double least = 0.0;
    for (std::size_t i = 0; i < chords_.size(); ++i) {
        const Chord& chord = chords_[i];
        const Vec2 from = hip - chord.middle;
        const double away = std::fabs(glm::dot(from, chord.outward));
        if (std::fabs(glm::dot(from, chord.along)) <= kMiddle * chord.half &&
            (nearest == kNone || away < least)) {
            nearest = i;
            least = away;
        }
    }
    return nearest;
}

/// Whether this tick is part of a settled stroke.
bool CurvatureCues::sliding(const engine::TickRecord& tick, std::size_t chord) noexcept {
    const Vec2 step(tick.hip - last_hip_);
    last_hip_ = tick.hip;
    if (chord == kNone || chord != chord_) {
        chord_ = chord;
        velocity_ = 0.0;
        kept_ = 0.0;
        return false;
    }
    const double moved = glm::dot(step, chords_[chord].along);
    const bool forward = velocity_ > 0.0;
    velocity_ += kSmoothing * (moved - velocity_);
    kept_ = (velocity_ > 0.0) == forward ? kept_ + std::fabs(moved) : 0.0;
    const bool rests = tick.mode == engine::Mode::stuck || tick.go == last_go_;
    last_go_ = tick.go;
    return kept_ >= kSettled && !rests;
}

void CurvatureCues::add(const engine::TickRecord& tick) noexcept {
    const bool pressed = tick.mode != engine::Mode::free && tick.normal_force > kFeltForce;
    const std::size_t where = pressed ? chord_at(Vec2(tick.hip)) : kNone;
    if (!sliding(tick, where)) {
        return;
    }
    const Chord& chord = chords_[where];
    const Vec2 from = Vec2(tick.hip) - chord.middle;
    const Vec2 force(tick.force);
    const double x = glm::dot(from, chord.along) / chord.half;
    const double y = glm::dot(from, chord.outward) / chord.half;
    const double a = engine::arc_tan2(glm::dot(force, chord.along), glm::dot(force, chord.outward));
    Strokes& s = strokes_[where][velocity_ > 0.0 ? 1 : 0];
    s.n += 1.0;
    s.x += x;
    s.x2 += x * x;
    s.x3 += x * x * x;
    s.x4 += x * x * x * x;
    s.a += a;
    s.xa += x * a;
    s.y += y;
    s.xy += x * y;
    s.x2y += x * x * y;
    friction_sum_ += std::fabs(tick.tangential_force) / tick.normal_force;
    friction_count_ += 1.0;
}

Cues CurvatureCues::cues() const noexcept {
    double spread_x = 0.0;  // pooled within chord and direction, as the separate intercepts ask
    double force = 0.0;
    double spread_bend = 0.0;
    double position = 0.0;
    for (std::size_t i = 0; i < chords_.size(); ++i) {
        const double half = chords_[i].half;
        for (const Strokes& s : strokes_[i]) {
            const double xx = spread(s.n, s.x, s.x2);
            if (xx < kMinSpread) {
                continue;
            }
            const double xq = s.x3 - s.x * s.x2 / s.n;  // q = x^2
            const double bend = (s.x4 - s.x2 * s.x2 / s.n) - xq * xq / xx;
            spread_x += xx;
            force += (s.xa - s.x * s.a / s.n) / half;
            spread_bend += bend;
            position +=
                -2.0 * ((s.x2y - s.x2 * s.y / s.n) - xq * (s.xy - s.x * s.y / s.n) / xx) / half;
        }
    }
    Cues cues;
    if (spread_x > 0.0) {
        cues.force = force / spread_x;
    }
    if (spread_bend > 0.0) {
        cues.position = position / spread_bend;
    }
    if (friction_count_ > 0.0) {
        cues.friction = friction_sum_ / friction_count_;
    }
    return cues;
}

SoftnessCues::SoftnessCues(const Protocol& protocol)
    : rest_(outline_of(
          protocol,
          *std::ranges::find(protocol.objects, protocol.procedure->object, &ObjectSpec::name))),
      feet_(*rest_) {}

void SoftnessCues::add(std::span<const engine::TickRecord> ticks) noexcept {
    for (const engine::TickRecord& tick : ticks) {
        const double force = glm::length(tick.force);
        if (++tick_ % kEach != 0 || force < kFeltForce) {
            continue;
        }
        const engine::ClosestPoint nearest = feet_.closest(engine::Vec2(tick.hip));
        if (nearest.inside) {
            product_ += force * nearest.distance;
            squares_ += force * force;
        }
    }
}

std::optional<double> SoftnessCues::softness() const noexcept {
    return product_ > 0.0 ? std::optional(product_ / squares_) : std::nullopt;
}

OutlineCues::OutlineCues(const Protocol& protocol, const std::vector<std::size_t>& pictures)
    : softness_(1.0 / protocol.apparatus.stiffness) {
    for (const std::size_t object : pictures) {
        if (protocol.surface) {
            surfaces_.emplace_back(surface_of(protocol, protocol.objects.at(object)));
            continue;
        }
        outlines_.push_back(outline_of(protocol, object));
        feet_.emplace_back(*outlines_.back());
    }
    forget();
}

void OutlineCues::forget() noexcept {
    squares_.assign(feet_.size() + surfaces_.size(), 0.0);
    tracks_.assign(surfaces_.size(), {});
    points_ = 0.0;
    tick_ = 0;
}

void OutlineCues::add(std::span<const engine::TickRecord> ticks) noexcept {
    for (const engine::TickRecord& tick : ticks) {
        const double pressed = glm::length(tick.force);
        if (tick.mode == engine::Mode::free || !(pressed > kFeltForce) || tick_++ % kEach != 0) {
            continue;
        }
        const engine::Vec3 felt = tick.hip + softness_ * tick.force;
        for (std::size_t i = 0; i < surfaces_.size(); ++i) {
            const double away = surfaces_[i].track(tracks_[i], felt).distance;
            squares_[i] += away * away;
        }
        const engine::Vec2 surface(felt);
        for (std::size_t i = 0; i < feet_.size(); ++i) {
            const double away = feet_[i].closest(surface).distance;
            squares_[i] += away * away;
        }
        points_ += 1.0;
    }
}

std::vector<double> OutlineCues::misfits() const {
    std::vector<double> misfits(squares_.size(), 0.0);
    if (felt()) {
        std::transform(squares_.begin(), squares_.end(), misfits.begin(),
                       [this](double square) { return std::sqrt(square / points_); });
    }
    return misfits;
}

}  // namespace palpate::protocols
