#include "tests/stress/tick_laws.hpp"

#include "engine/geometry/cusps.hpp"
#include "engine/math/elementary.hpp"
#include "tests/stress/stress_scene.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;

/// So does the foot that is followed where the distance has hardly a minimum: 5e-12 of the size was
/// seen.
constexpr double kFootSlack = 10.0;

/// How far from the exact first root a god-object may stop, of the object's size.
constexpr double kFirstRoot = 1e-9;

/// A followed foot counts as sharp while f' is a tenth of |C'|^2: it may be ten times as far from
/// one that was searched for as the rounding of four lengths.
constexpr double kBlunt = 40.0;

}  // namespace

TickLaws::TickLaws(const engine::Scene& scene)
    : scene_(&scene),
      feet_(scene.outline()),
      exact_(scene.outline()),
      size_(size_of(scene.outline())),
      extent_(exact_.extent) {}

std::optional<Breach> TickLaws::look(const Vec2& h,
                                     const engine::ContactState& before,
                                     const engine::ContactState& after,
                                     const Contact& contact) {
    breach_.reset();
    Tick now{.h = h, .contact = contact};
    check_numbers(contact);
    if (!finite(h)) {
        check("a HIP that is not finite is refused without force",
              contact.refused && free(contact) && contact.force == Vec2{});
        after_refusal_ = true;
        started_ = ledger_ = false;
        ++ticks_;
        return breach_;
    }
    check("a finite HIP is not refused", !contact.refused);
    const double reach = std::max(largest(h), started_ ? largest(last_.h) : 0.0);
    if (reach > kFar) {
        started_ = true;
        ledger_ = after_refusal_ = false;
        last_ = now;
        last_.contact.mode = Mode::free;
        last_far_ = true;
        ++ticks_;
        return breach_;
    }
    same_ = kSameLength * std::max(extent_, reach);
    const bool exact = !contact.outside_cone && !contact.vertex_slew && !at_open_end(contact.place);
    now.springy = scene_->spec().damping == 0.0 && !free(contact) && exact;
    check_closest(now);
    check_free(now);
    if (!free(contact)) {
        check_force(now);
        check_walk(now, before);
    }
    check_first_root(now, before, after);
    check_step(now);
    const double k = scene_->spec().stiffness;
    check_energy(last_, now, now.springy, k, k * same_ * std::max(extent_, largest(h)));
    if (after_refusal_) {
        check_recovery(now);
    }
    started_ = true;
    after_refusal_ = last_far_ = false;
    last_ = now;
    ++ticks_;
    return breach_;
}

void TickLaws::check_free(const Tick& now) {
    const Contact& c = now.contact;
    check("mu is between mu_d and mu_s, and 0 while free",
          free(c) ? c.mu == 0.0
                  : c.mu >= scene_->spec().friction.mu_d * (1.0 - 1e-15) &&
                        c.mu <= scene_->spec().friction.mu_s * (1.0 + 1e-15));
    if (free(c) && !c.skipped && (!started_ || (free(last_.contact) && !last_far_))) {
        // Round an open end a hand comes to the back, deeper than it moved, and stays there.
        const bool behind = !scene_->outline().closed() && started_ &&
                            (last_.cp.inside || now.cp.distance > glm::length(now.h - last_.h));
        check("a hand inside is touched",
              !now.cp.inside || behind || now.cp.distance <= kFootSlack * same_ ||
                  on_end_normal(now.cp.place, now.h) || on_knife_edge(now.cp.place) ||
                  outside_of_some(exact_, now.h, now.cp.distance + kFootSlack * same_));
    }
}

/// The certified closest point is the global one.
void TickLaws::check_closest(Tick& now) {
    const engine::ClosestPoint global = feet_.closest(now.h);
    now.cp = scene_->closest(track_, now.h);
    const engine::ClosestPoint& cp = now.cp;
    if (now.contact.skipped) {
        check("what is skipped is out of reach",
              global.distance > 0.0 || last_.cp.distance <= kFootSlack * same_);
    } else if (free(now.contact)) {
        check("out of contact the god-object is the closest point",
              std::fabs(glm::length(now.contact.go - now.h) - global.distance), kFootSlack * same_);
    }
    check("the closest point is the global one", std::fabs(cp.distance - global.distance),
          kFootSlack * same_);
    check("the closest point is as far as it says",
          std::fabs(glm::length(cp.point - now.h) - cp.distance), same_);
}

void TickLaws::check_force(const Tick& now) {
    const Contact& c = now.contact;
    const double k = scene_->spec().stiffness;
    const double per_metre = k + scene_->spec().damping / scene_->spec().period;
    const double newton = per_metre * (same_ + resolution(c.place));
    if (now.springy) {
        check("the force is K (GO - HIP)", glm::length(c.force - k * (c.go - now.h)), k * same_);
    }
    const bool corner = in_corner(c);
    if (!corner || scene_->spec().damping == 0.0) {
        check("fn and ft are the components of the force",
              std::fabs(glm::length(c.force) - std::sqrt(c.normal_force * c.normal_force +
                                                         c.tangential_force * c.tangential_force)),
              newton + 1e-12 * glm::length(c.force));
    }
    if (!corner) {
        const double turned = (1.0 + c.mu) * turn_of_last_bits(c.place) * glm::length(c.go - now.h);
        check("friction stays in its cone", std::fabs(c.tangential_force),
              c.mu * c.normal_force * (1.0 + 1e-9) + kConeSlack * newton + per_metre * turned);
    }
}

void TickLaws::check_walk(const Tick& now, const engine::ContactState& before) {
    const Contact& c = now.contact;
    const auto& outline = scene_->outline();
    check("without slew the walk finds its end", !c.vertex_slew || !scene_->spec().slew.none());
    const Vec2 there = c.place.on_seam ? outline.seams()[c.place.index].point
                                       : outline.spans()[c.place.index].at(c.place.parameter).point;
    check("the god-object is on the outline", glm::length(there - c.go),
          same_ + resolution(c.place));
    const bool touched = before.touching && started_ && !c.began;
    const double stretch = glm::length(c.go - now.h);
    if (!touched) {
        check("a contact begins no further than the closest point", stretch,
              feet_.closest(now.h).distance + kFootSlack * same_ + resolution(c.place));
        return;
    }
    const Contact& l = last_.contact;
    check("the walk never stretches the spring", stretch, glm::length(l.go - now.h) + same_);
    if (c.mode == Mode::stuck) {
        check("a stuck god-object does not move", glm::length(c.go - l.go), same_);
    }
    const bool same_span = !c.place.on_seam && !l.place.on_seam && c.place.index == l.place.index &&
                           c.place.parameter > 0.0 && c.place.parameter < 1.0 &&
                           outline.spans().size() > 1;
    if (now.springy && same_span && c.mode != Mode::stuck) {
        const double turned = (1.0 + c.mu) * turn_of_last_bits(c.place) * stretch;
        check("a slip ends on the edge of the cone", c.mu * c.normal_force,
              std::fabs(c.tangential_force) +
                  scene_->spec().stiffness * (1e3 * (same_ + resolution(c.place)) + turned));
    }
}

/// From where it was, in the direction of its drive, to the first place in the cone and no further;
/// contact ends if HIP is outside there.
void TickLaws::check_first_root(const Tick& now,
                                const engine::ContactState& before,
                                const engine::ContactState& after) {
    const auto& spec = scene_->spec();
    if (!before.touching || !spec.slew.none()) {
        return;
    }
    const auto& outline = scene_->outline();
    const double mu = spec.friction.none() ? 0.0 : engine::coefficient(spec.friction, before.theta);
    const ExactAnswer exact = exact_walk(exact_, before.go, now.h, mu);
    ++walks;
    ties += exact.open || exact.stops.size() > 1 ? 1U : 0U;
    if (exact.open) {
        return;
    }
    double nearest = 2.0 * kFirstRoot;
    const engine::GodObject& go = after.go;
    const Vec2 there = go.place.on_seam ? outline.seams()[go.place.index].point : go.spot.jet.point;
    bool may_end = false;
    for (const ExactStop& stop : exact.stops) {
        const double band = exact.band + stop.doubt;
        may_end = may_end || stop.nu <= band || stop.corner;
        if (stop.corner || stop.nu >= -band) {
            const double apart = glm::length(stop.point - there) - stop.blur;
            nearest = std::min(nearest, apart / size_);
        }
    }
    if (free(now.contact) || now.contact.began) {
        check("contact ends only where the first place in the cone has no load", may_end);
    } else {
        check("the god-object stops at the first place in its cone", nearest,
              kFirstRoot + 4.0 * engine::kEpsilon * extent_ / size_);
    }
}

/// |dF| <= K (|dh| + |dg|), and on a line |dg| <= |dh| (1 + mu) + (mu_s - mu_d) depth T / tau_slip.
void TickLaws::check_step(const Tick& now) {
    if (!started_ || !now.springy || !last_.springy) {
        return;
    }
    const auto& spec = scene_->spec();
    const Contact& c = now.contact;
    const Contact& l = last_.contact;
    const double dh = glm::length(now.h - last_.h);
    const double dg = glm::length(c.go - l.go);
    check("the force steps no further than HIP and GO", glm::length(c.force - l.force),
          spec.stiffness * (dh + dg) * (1.0 + 1e-12) + spec.stiffness * same_);
    const bool line = !c.began && !c.place.on_seam && !l.place.on_seam &&
                      c.place.index == l.place.index &&
                      scene_->outline().spans()[c.place.index].degree() == 1;
    if (line) {
        const double share = spec.friction.tau_slip > 0.0
                               ? std::min(spec.period / spec.friction.tau_slip, 1.0)
                               : 1.0;
        const double relaxed = (spec.friction.mu_s - spec.friction.mu_d) * share;
        const double depth = c.normal_force / spec.stiffness;
        check("on a line GO moves as far as HIP and mu let it", dg,
              dh * (1.0 + l.mu) + relaxed * depth + 4.0 * same_ + resolution(c.place));
    }
}

/// After a refused tick the contact is that of a hand that comes out of nowhere.
void TickLaws::check_recovery(const Tick& now) {
    if (!scene_->spec().slew.none()) {
        return;  // the budget knows how far HIP came
    }
    engine::ContactState fresh;
    const Contact again = scene_->tick(fresh, now.h);
    const Contact& c = now.contact;
    const engine::ClosestPoint global = feet_.closest(now.h);
    if (glm::length(global.point - now.cp.point) > same_ || now.cp.distance <= 1e3 * same_) {
        return;  // two closest points, or on the surface: either will do
    }
    if (on_end_normal(now.cp.place, now.h) || on_end_normal(global.place, now.h)) {
        return;  // where an open chain stops being seen rounding decides
    }
    check("after a refused tick the contact is a new one", free(again) == free(c));
    check("after a refused tick the force is that of a new contact",
          glm::length(again.force - c.force),
          (scene_->spec().stiffness + scene_->spec().damping / scene_->spec().period) *
              (kBlunt * same_ + resolution(now.cp.place)));
}

/// What a slide leaves open at a place, m: it ends up to 2^19 last bits of u beyond the root, and
/// those are worth most where a heavy control point makes |C'| large.
double TickLaws::resolution(const Place& place) const noexcept {
    constexpr double kLastBits = 0x1p-33;
    return place.on_seam
             ? 0.0
             : kLastBits *
                   glm::length(scene_->outline().spans()[place.index].at(place.parameter).first);
}

/// How far the last bits of u, and of the tangent itself, turn the tangent, rad: in a hairpin
/// within a span they tell.
double TickLaws::turn_of_last_bits(const Place& place) const noexcept {
    if (place.on_seam || place.parameter == 0.0 || place.parameter == 1.0) {
        return 0.0;
    }
    const auto jet = scene_->outline().spans()[place.index].at(place.parameter);
    const double speed = glm::length(jet.first);
    const double bits = 4.0 * engine::kEpsilon * glm::length(jet.second);
    const double rounding = static_cast<double>(
        turned_in_doubles(exact_.on[place.index], place.parameter, 1.0L - place.parameter));
    return bits < 2.0 * speed ? std::min(bits / speed + rounding, 2.0) : 2.0;
}

bool TickLaws::at_open_end(const Place& place) const noexcept {
    constexpr double kNear = 1e-6;  // where repeated control points make the curve stand still
    if (place.on_seam || (place.parameter > kNear && place.parameter < 1.0 - kNear)) {
        return false;
    }
    return !scene_->outline().seam_beyond(place.index, place.parameter > 0.5);
}

/// On the line through an open end that is square to the curve.
bool TickLaws::on_end_normal(const Place& place, const Vec2& h) const noexcept {
    if (!at_open_end(place)) {
        return false;
    }
    const auto& span = scene_->outline().spans()[place.index];
    const bool last = place.parameter > 0.5;
    const Vec2 gap = h - span.at(last ? 1.0 : 0.0).point;
    return std::fabs(glm::dot(gap, engine::end_tangent(span, last))) <= kFootSlack * same_;
}

/// Two curves run back along each other, less than 1e-6 rad apart: which of them is nearer to a
/// hand beyond their tip, and so its side, rounding decides.
bool TickLaws::on_knife_edge(const Place& place) const noexcept {
    constexpr double kNear = 1e-6;
    const engine::Outline& outline = scene_->outline();
    std::optional<std::size_t> seam;
    if (place.on_seam) {
        seam = place.index;
    } else if (place.parameter <= kNear || place.parameter >= 1.0 - kNear) {
        seam = outline.seam_beyond(place.index, place.parameter > 0.5);
    }
    return seam && outline.seams()[*seam].turn > engine::kPi - 1e-6;
}

bool TickLaws::in_corner(const Contact& contact) const noexcept {
    return contact.place.on_seam &&
           scene_->outline().seams()[contact.place.index].kind == SeamKind::concave;
}

}  // namespace palpate::stress
