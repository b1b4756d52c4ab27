#include "protocols/format/rules.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/contact/closest_point.hpp"
#include "stimuli/two_curve.hpp"
#include "protocols/design/constrained_order.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/format/adaptive_rules.hpp"
#include "protocols/format/keys.hpp"
#include "protocols/format/response_rules.hpp"

namespace palpate::protocols {
namespace {

using engine::Vec2;

/// Largest |curvature| * chord / 2: the sine of an arc's half sweep. 0.95 is a sweep of 144 degrees;
/// beyond it the two curves look like circles, and the arc comes near what one curve can hold.
constexpr double kMaxHalfSine = 0.95;
/// A vertex lower than this above its base line is no object to feel, m.
constexpr double kMinHeight = 0.001;

double millimetres(double metres) {
    return std::round(metres * 1e9) / 1e6;
}

/// Angle between two directions, rad.
double angle(const Vec2& a, const Vec2& b) {
    return std::atan2(std::fabs(engine::cross(a, b)), glm::dot(a, b));
}

class Rules {
public:
    Rules(const Protocol& protocol, const Places& places, Problems& problems)
        : protocol_(protocol), places_(places), problems_(problems) {}

    void check() {
        unique_names("object", protocol_.objects);
        unique_names("friction", protocol_.frictions);
        numbers();
        pictures_differ();
        if (outline()) {
            for (std::size_t i = 0; i < protocol_.objects.size(); ++i) {
                if (object_fits(i) && !start_is_outside(i)) {
                    break;  // one object says it for all
                }
            }
        }
        for (std::size_t i = 0; i < protocol_.frictions.size(); ++i) {
            friction(i);
        }
        timing();
        if (!protocol_.procedure) {
            design();
        }
    }

private:
    void add(const std::string& path, std::string what) {
        problems_.add(places_.of(path), std::move(what));
    }

    static std::string path(std::string_view table, std::size_t index, std::string_view key) {
        return fmt::format("{}.{}.{}", table, index + 1, key);
    }

    template <class Spec>
    void unique_names(std::string_view table, const std::vector<Spec>& specs) {
        std::map<std::string_view, std::size_t> first;
        for (std::size_t i = 0; i < specs.size(); ++i) {
            const auto [known, is_new] = first.emplace(specs[i].name, i);
            if (!is_new) {
                add(path(table, i, "name"),
                    fmt::format("name is \"{}\", as in [[{}]] {}: give every {} a name of its own",
                                specs[i].name, table, known->second + 1, table));
            }
        }
    }

    void numbers() {
        const std::size_t pictured = objects_of(protocol_, true).size();
        const bool asked = protocol_.response.kind == ResponseKind::identification;
        if (asked && (pictured < kMinPictures || pictured > kMaxPictures)) {
            add("object.1",
                fmt::format("there are {} pictured objects: give {} to {} [[object]] tables "
                            "without pictured = false",
                            pictured, kMinPictures, kMaxPictures));
        }
        if (protocol_.objects.size() > kMaxObjects) {
            add("object.1", fmt::format("there are {} objects: give at most {}",
                                        protocol_.objects.size(), kMaxObjects));
        }
        if (protocol_.frictions.empty() || protocol_.frictions.size() > kMaxFrictions) {
            add("friction.1",
                fmt::format("there are {} frictions: give 1 to {} [[friction]] tables",
                            protocol_.frictions.size(), kMaxFrictions));
        }
    }

    /// Two equal pictures could not be told apart by anybody.
    void pictures_differ() {
        std::map<double, std::size_t> first;
        for (const std::size_t i : objects_of(protocol_, true)) {
            const double curvature = protocol_.objects[i].curvature;
            const auto [known, is_new] = first.emplace(curvature, i);
            if (!is_new) {
                add(path("object", i, "curvature_per_m"),
                    fmt::format("curvature_per_m is {}, as in [[object]] {}: pictured objects need "
                                "curvatures of their own",
                                curvature, known->second + 1));
            }
        }
    }

    bool outline() {
        const auto& [a, vertex, b] = protocol_.outline;
        if (!(a.x < vertex.x && vertex.x < b.x)) {
            add("outline.vertex_mm",
                fmt::format("x of A, V and B are {}, {} and {}: give them from left to right",
                            millimetres(a.x), millimetres(vertex.x), millimetres(b.x)));
            return false;
        }
        const double height = engine::cross(b - a, vertex - a) / glm::length(b - a);
        if (height < kMinHeight) {
            add("outline.vertex_mm",
                fmt::format("the vertex is {} mm above the base line A-B: give at least {}",
                            millimetres(height), millimetres(kMinHeight)));
            return false;
        }
        return true;
    }

    bool object_fits(std::size_t index) {
        const auto& [a, vertex, b] = protocol_.outline;
        const double curvature = protocol_.objects[index].curvature;
        const std::string at = path("object", index, "curvature_per_m");
        const double chord = std::max(glm::length(vertex - a), glm::length(b - vertex));
        if (std::fabs(curvature) * chord / 2.0 >= kMaxHalfSine) {
            add(at,
                fmt::format(
                    "curvature_per_m is {}, too strong for a chord of {:.1f} mm: stay below {:.1f} "
                    "either way",
                    curvature, 1e3 * chord, 2.0 * kMaxHalfSine / chord));
            return false;
        }
        if (curvature < 0.0 && !leaves_room(-curvature)) {
            add(at, fmt::format(
                        "curvature_per_m is {}: curves as hollow as this meet each other or the "
                        "base line; give a value nearer to 0, or a wider angle at A, V or B",
                        curvature));
            return false;
        }
        return true;
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

    bool start_is_outside(std::size_t index) {
        const ObjectSpec& object = protocol_.objects[index];
        const Vec2& start = protocol_.apparatus.start;
        try {
            const auto outline = stimuli::make_outline({.a = protocol_.outline.a,
                                                        .vertex = protocol_.outline.vertex,
                                                        .b = protocol_.outline.b,
                                                        .curvature = object.curvature});
            if (engine::OutlineFeet(*outline).closest(start).inside) {
                add("apparatus.start_mm",
                    fmt::format("start_mm is [{}, {}], inside the object {}: give a point outside "
                                "all objects",
                                millimetres(start.x), millimetres(start.y), object.name));
                return false;
            }
        } catch (const std::invalid_argument& error) {
            add(path("object", index, "curvature_per_m"),
                fmt::format("the object {} cannot be built: {}", object.name, error.what()));
        }
        return true;
    }

    void friction(std::size_t index) {
        const FrictionSpec& spec = protocol_.frictions[index];
        if (spec.mu_d > spec.mu_s) {
            add(path("friction", index, "mu_d"),
                fmt::format("mu_d is {}, above mu_s = {}: give at most mu_s", spec.mu_d,
                            spec.mu_s));
        }
    }

    void timing() {
        const TimingSpec& timing = protocol_.timing;
        if (timing.explore_min >= timing.explore_timeout) {
            add(places_.has("timing.explore_min_s") ? "timing.explore_min_s"
                                                    : "timing.explore_timeout_s",
                fmt::format(
                    "explore_min_s is {} and explore_timeout_s is {}: nobody could answer; give a "
                    "time-out above the minimum",
                    timing.explore_min, timing.explore_timeout));
        }
        if (timing.explore_prompt > timing.explore_timeout) {
            add(places_.has("timing.explore_prompt_s") ? "timing.explore_prompt_s"
                                                       : "timing.explore_timeout_s",
                fmt::format("explore_prompt_s is {}, after explore_timeout_s = {}: give at most "
                            "the time-out",
                            timing.explore_prompt, timing.explore_timeout));
        }
    }

    void design() {
        const DesignSpec& design = protocol_.design;
        const std::size_t conditions =
            objects_of(protocol_, true).size() * protocol_.frictions.size();
        const std::size_t trials =
            conditions * (design.repetitions + design.practice_repetitions) + design.catch_trials +
            (design.order == OrderRule::first_order ? 1 : 0);  // the one that leads in
        if (trials > kMaxTrials) {
            add("design.repetitions",
                fmt::format("the session has {} trials: ask for {} or fewer", trials, kMaxTrials));
            return;
        }
        if (design.catch_trials > 0 && objects_of(protocol_, false).empty()) {
            add("design.catch_trials",
                fmt::format(
                    "catch_trials is {}, but every object is pictured: add an [[object]] with "
                    "pictured = false, or give 0",
                    design.catch_trials));
        }
        if (design.order == OrderRule::first_order) {
            first_order(conditions);
            return;
        }
        if (design.repetitions % design.blocks != 0) {
            add("design.blocks",
                fmt::format("blocks is {}, but {} repetitions cannot be divided evenly into them: "
                            "give a divisor",
                            design.blocks, design.repetitions));
            return;
        }
        if (const auto why = why_infeasible(
                factorial(protocol_, design.repetitions / design.blocks),
                {.object = design.max_run_object, .friction = design.max_run_friction})) {
            const bool of_object = why->factor == Infeasible::Factor::object;
            const std::string key = of_object ? "max_run_object" : "max_run_friction";
            add("design." + key,
                fmt::format("{} is {}: {}", key,
                            of_object ? design.max_run_object : design.max_run_friction,
                            why->reason));
        }
    }

    /// Such an order follows from the number of conditions; the run limits do not apply.
    void first_order(std::size_t conditions) {
        const DesignSpec& design = protocol_.design;
        const auto needs = [&](const std::string& key, std::size_t given, std::size_t wanted,
                               std::string_view why) {
            if (given != wanted) {
                add("design." + key,
                    fmt::format("{} is {}: order = \"first_order\" {}: give {}, or order = "
                                "\"random\"",
                                key, given, why, wanted));
            }
        };
        needs("repetitions", design.repetitions, conditions,
              fmt::format("lets each of {} conditions follow each once", conditions));
        needs("blocks", design.blocks, 1, "is one block");
        needs("catch_trials", design.catch_trials, 0, "has no room for catch trials");
    }

    const Protocol& protocol_;
    const Places& places_;
    Problems& problems_;
};

}  // namespace

void check_rules(const Protocol& protocol, const Places& places, Problems& problems) {
    Rules(protocol, places, problems).check();
    check_response(protocol, places, problems);
    if (protocol.procedure) {
        check_adaptive(protocol, places, problems);
    }
}

}  // namespace palpate::protocols
