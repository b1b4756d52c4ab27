#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/contact/closest_point.hpp"
#include "engine/surface/surface_scene.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/file/outline_shape.hpp"
#include "protocols/file/rules.hpp"

namespace palpate::protocols {
namespace {

using engine::Vec2;

/// A vertex lower than this above its base line is no object to feel, m.
constexpr double kMinHeight = 0.001;

double millimetres(double metres) {
    return std::round(metres * 1e9) / 1e6;
}

/// Angle between two directions, rad.
double angle(const Vec2& a, const Vec2& b) {
    return std::atan2(std::fabs(engine::cross(a, b)), glm::dot(a, b));
}

/// Farthest from the origin along an axis, m: as far as any other place of the format may be.
constexpr double kFarthest = 1.0;

/// They would look the same, wherever they stand in the file.
bool alike(const ObjectSpec& a, const ObjectSpec& b) {
    return a.curvature == b.curvature && a.cross_curvature == b.cross_curvature &&
           a.pose() == b.pose() && a.segments == b.segments;
}

class ObjectRules : RuleCheck {
public:
    using RuleCheck::RuleCheck;

    void check() {
        pictures_differ();
        if (protocol_.surface) {
            surfaces();
            return;
        }
        for (std::size_t i = 0; i < protocol_.objects.size(); ++i) {
            add_if(protocol_.objects[i].cross_curvature != 0.0, path(i, "cross_curvature_per_m"),
                   "the object {} has a cross_curvature_per_m, which only surfaces have: delete "
                   "it, or add the table [surface]",
                   protocol_.objects[i].name);
        }
        softness();
        if (outline()) {
            for (std::size_t i = 0; i < protocol_.objects.size(); ++i) {
                if (!object(i)) {
                    break;  // one object says it for all
                }
            }
        }
    }

private:
    static std::string path(std::size_t object, std::string_view key) {
        return fmt::format("object.{}.{}", object + 1, key);
    }

    /// Two equal pictures could not be distinguished by anybody.
    void pictures_differ() {
        const std::vector<std::size_t> pictured = objects_of(protocol_, true);
        for (auto one = pictured.begin(); one != pictured.end(); ++one) {
            const ObjectSpec& object = protocol_.objects[*one];
            const auto known = std::find_if(pictured.begin(), one, [&](std::size_t other) {
                return alike(protocol_.objects[other], object);
            });
            if (known == one) {
                continue;
            }
            const bool curves = object.segments.empty();
            add_if(curves, path(*one, "curvature_per_m"),
                   "curvature_per_m is {}, as in [[object]] {}: pictured objects need curvatures "
                   "of their own",
                   object.curvature, *known + 1);
            add_if(!curves, path(*one, "segment.1"),
                   "the object {} has the outline of [[object]] {}: pictured objects need outlines "
                   "of their own",
                   object.name, *known + 1);
        }
    }

    /// What a surface is: a patch of two curvatures, rigid, as it stands.
    void surfaces() {
        add_if(places_.has("outline"), "outline",
               "[outline] is given beside [surface], and only objects in the plane have one: "
               "delete one of the two");
        add_if(protocol_.procedure && protocol_.procedure->varies != Varies::mu, "procedure.varies",
               "varies is no friction, and the objects are surfaces: give \"mu\", or delete "
               "[surface]");
        bool sound = friction_of_surfaces();
        for (std::size_t i = 0; i < protocol_.objects.size() && sound; ++i) {
            sound = surface(i);
        }
    }

    bool friction_of_surfaces() {
        bool known = true;
        for (std::size_t i = 0; i < protocol_.frictions.size(); ++i) {
            const FrictionSpec& friction = protocol_.frictions[i];
            known &= !add_if(engine::law_named(friction.law) != nullptr,
                             fmt::format("friction.{}.law", i + 1),
                             "law is \"{}\", which surfaces do not have: give \"frictionless\", "
                             "\"gos\" or \"coulomb\"",
                             friction.law);
        }
        return known;
    }

    bool bears_contact(const std::shared_ptr<const engine::NurbsSurface>& surface,
                       const std::string& name) {
        const ApparatusSpec& apparatus = protocol_.apparatus;
        try {
            static_cast<void>(engine::SurfaceScene(
                surface, engine::SceneSpec{.stiffness = apparatus.stiffness,
                                           .damping = apparatus.damping,
                                           .period = 1.0 / apparatus.rate_hz,
                                           .slew = {.speed = apparatus.vertex_slew,
                                                    .radius = apparatus.vertex_radius}}));
            return true;
        } catch (const std::invalid_argument& error) {
            add(apparatus.vertex_slew > 0.0 ? "apparatus.vertex_slew_mm_per_s"
                                            : "apparatus.damping_n_s_per_m",
                fmt::format("the object {} is a surface, and {}", name, error.what()));
            return false;
        }
    }

    /// @return false where one object says it for all
    bool surface(std::size_t index) {
        const ObjectSpec& object = protocol_.objects[index];
        if (add_if(!object.segments.empty() || object.pose() != stimuli::Pose{} ||
                       object.compliance > 0.0,
                   path(index, "name"),
                   "the object {} has segments, a place or a compliance of its own: a surface has "
                   "curvature_per_m and cross_curvature_per_m alone",
                   object.name)) {
            return true;
        }
        std::shared_ptr<const engine::NurbsSurface> built;
        try {
            built = surface_of(protocol_, object);
        } catch (const std::invalid_argument& error) {
            add(path(index, "curvature_per_m"),
                fmt::format("the object {} cannot be built: {}", object.name, error.what()));
            return true;
        }
        if (!bears_contact(built, object.name)) {
            return false;
        }
        const engine::Vec3 start(protocol_.apparatus.start, protocol_.surface->start_height);
        return !add_if(engine::SurfaceFeet(built).closest(start).inside, "surface.start_height_mm",
                       "start_height_mm is {}, inside the object {}: give more",
                       millimetres(start.z), object.name);
    }

    /// What yields is two curves, under a contact of one spring and friction in its cone.
    void softness() {
        const bool varied =
            protocol_.procedure && protocol_.procedure->varies == Varies::compliance;
        std::size_t soft = protocol_.objects.size();
        for (std::size_t i = 0; i < protocol_.objects.size(); ++i) {
            if (!(protocol_.objects[i].compliance > 0.0)) {
                continue;
            }
            soft = std::min(soft, i);
            add_if(!protocol_.objects[i].segments.empty(), path(i, "compliance_mm_per_n"),
                   "the object {} is a free form: a compliance is of two curves; delete it, or "
                   "give curvature_per_m",
                   protocol_.objects[i].name);
        }
        if (soft == protocol_.objects.size() && !varied) {
            return;
        }
        const std::string what =
            varied ? std::string("the rule varies a compliance")
                   : fmt::format("the object {} has a compliance", protocol_.objects[soft].name);
        soft_contact(what);
    }

    /// @param what  yields
    void soft_contact(const std::string& what) {
        const ApparatusSpec& apparatus = protocol_.apparatus;
        add_if(apparatus.vertex_slew > 0.0, "apparatus.vertex_slew_mm_per_s",
               "{}, and vertex_slew_mm_per_s is {:g}: give 0, a vertex that yields needs none",
               what, 1e3 * apparatus.vertex_slew);
        add_if(apparatus.damping != 0.0, "apparatus.damping_n_s_per_m",
               "{}, and damping_n_s_per_m is {:g}: give 0, the object has a damping of its own",
               what, apparatus.damping);
        for (std::size_t i = 0; i < protocol_.frictions.size(); ++i) {
            const FrictionSpec& friction = protocol_.frictions[i];
            add_if(engine::law_named(friction.law) != nullptr,
                   fmt::format("friction.{}.law", i + 1),
                   "{}, and law is \"{}\": give \"frictionless\", \"gos\" or \"coulomb\"", what,
                   friction.law);
        }
    }

    bool outline() {
        const auto& [a, vertex, b] = protocol_.outline;
        if (add_if(!(a.x < vertex.x && vertex.x < b.x), "outline.vertex_mm",
                   "x of A, V and B are {}, {} and {}: give them from left to right",
                   millimetres(a.x), millimetres(vertex.x), millimetres(b.x))) {
            return false;
        }
        const double height = engine::cross(b - a, vertex - a) / glm::length(b - a);
        return !add_if(height < kMinHeight, "outline.vertex_mm",
                       "the vertex is {} mm above the base line A-B: give at least {}",
                       millimetres(height), millimetres(kMinHeight));
    }

    bool object_fits(std::size_t index) {
        const auto& [a, vertex, b] = protocol_.outline;
        const double curvature = protocol_.objects[index].curvature;
        const std::string at = path(index, "curvature_per_m");
        const double chord = std::max(glm::length(vertex - a), glm::length(b - vertex));
        return !add_if(std::fabs(curvature) * chord / 2.0 >= kMaxHalfSine, at,
                       "curvature_per_m is {}, too strong for a chord of {:.1f} mm: stay below "
                       "{:.1f} either way",
                       curvature, 1e3 * chord, 2.0 * kMaxHalfSine / chord) &&
               !add_if(curvature < 0.0 && !leaves_room(-curvature), at,
                       "curvature_per_m is {}: curves as hollow as this meet each other or the "
                       "base line; give a value nearer to 0, or a wider angle at A, V or B",
                       curvature);
    }

    /// Hollow curves stay apart if at every corner the angle between the chords is larger than what
    /// the arcs take of it: each lies between its chord and its tangent.
    [[nodiscard]] bool leaves_room(double hollow) const {
        const auto& [a, vertex, b] = protocol_.outline;
        const double left = std::asin(hollow * glm::length(vertex - a) / 2.0);
        const double right = std::asin(hollow * glm::length(b - vertex) / 2.0);
        return angle(vertex - a, b - a) > left && angle(a - b, vertex - b) > right &&
               angle(a - vertex, b - vertex) > left + right;
    }

    bool start_is_outside(std::size_t index, const engine::Outline& outline) {
        const Vec2& start = protocol_.apparatus.start;
        return !add_if(
            engine::OutlineFeet(outline).closest(start).inside, "apparatus.start_mm",
            "start_mm is [{}, {}], inside the object {}: give a point outside all objects",
            millimetres(start.x), millimetres(start.y), protocol_.objects[index].name);
    }

    /// The placed outline, if the engine takes it.
    std::shared_ptr<const engine::Outline> built(std::size_t index) {
        const ObjectSpec& object = protocol_.objects[index];
        try {
            return outline_of(protocol_, index);
        } catch (const std::invalid_argument& error) {
            add(path(index,
                     object.segments.empty() ? "curvature_per_m" : spoken_segment(error.what())),
                fmt::format("the object {} cannot be built: {}", object.name, error.what()));
            return nullptr;
        }
    }

    bool is_closed(std::size_t index) {
        const ObjectSpec& object = protocol_.objects[index];
        const double gap =
            closing_gap({curve_of(object.segments.front()), curve_of(object.segments.back())});
        return !add_if(!(gap <= kSameEnd),
                       path(index, fmt::format("segment.{}", object.segments.size())), "{}",
                       gap_text("the object " + object.name, gap));
    }

    /// A size that can be felt, not out of every reach. Control points bound the curves.
    bool has_room(std::size_t index, const engine::Outline& outline) {
        Vec2 low = outline.spans().front().point(0);
        Vec2 high = low;
        for (const auto& span : outline.spans()) {
            for (std::size_t k = 0; k <= static_cast<std::size_t>(span.degree()); ++k) {
                low = glm::min(low, span.point(k));
                high = glm::max(high, span.point(k));
            }
        }
        const ObjectSpec& object = protocol_.objects[index];
        const double farthest = std::max({-low.x, -low.y, high.x, high.y});
        const double least = std::min(high.x - low.x, high.y - low.y);
        return !add_if(!(farthest <= kFarthest), placed_at(index),
                       "the object {} (its control points) reaches {:.6g} mm from the origin along "
                       "an axis: keep it within {:g} mm",
                       object.name, 1e3 * farthest, 1e3 * kFarthest) &&
               !add_if(!(least >= kMinHeight), placed_at(index),
                       "the object {} is {:.6g} mm wide or high: give at least {:g}", object.name,
                       1e3 * least, 1e3 * kMinHeight);
    }

    bool is_simple(std::size_t index, const engine::Outline& outline) {
        const auto meeting =
            crossing_text("the outline of " + protocol_.objects[index].name, outline);
        return !add_if(meeting.has_value(), path(index, "segment.1"), "{}", meeting.value_or(""));
    }

    /// @return whether the start of a trial is outside, as far as is known
    bool object(std::size_t index) {
        const bool free = !protocol_.objects[index].segments.empty();
        if (free ? !is_closed(index) : !object_fits(index)) {
            return true;
        }
        const auto outline = built(index);
        if (!outline || !has_room(index, *outline) || (free && !is_simple(index, *outline))) {
            return true;
        }
        return start_is_outside(index, *outline);
    }

    /// What to look at when an object is too large or too small.
    [[nodiscard]] std::string placed_at(std::size_t index) const {
        for (const char* key : {"size", "offset_mm"}) {
            if (places_.has(path(index, key))) {
                return path(index, key);
            }
        }
        return path(index, "segment.1");
    }
};

}  // namespace

void check_objects(const Protocol& protocol, const Places& places, Problems& problems) {
    ObjectRules(protocol, places, problems).check();
}

}  // namespace palpate::protocols
