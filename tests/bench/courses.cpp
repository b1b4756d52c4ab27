#include "tests/bench/courses.hpp"

#include "tests/bench/hand.hpp"
#include "tests/bench/own_methods.hpp"
#include "tests/bench/peers/peers.hpp"

namespace palpate::bench {
namespace {

struct Path {
    std::string name;
    double nearest = 0.0;
    double farthest = 0.0;
};

const Path kTicks{"ticks, -3..-0.5 mm", -3e-3, -5e-4};
constexpr const char* kOver = "-3..+3 mm";

template <int D>
void append(Methods<D>& all, Methods<D> more) {
    for (auto& method : more) {
        all.push_back(std::move(method));
    }
}

std::vector<Vec2> hips_of(const Object& object, const Path& path, double seconds) {
    return hand_along(object,
                      {.seconds = seconds, .nearest = path.nearest, .farthest = path.farthest});
}

Course<2> closest_points(const Object& object, const Path& path, const CoursePlan& plan) {
    Course<2> course{object.name, path.name, hips_of(object, path, plan.seconds),
                     own_methods(object)};
    if (plan.peers) {
        append(course.methods, peer_methods(object));
    }
    append(course.methods, soft_methods(object));
    course.truths = [object, hips = course.hips] {
        return truths(object, hips);
    };
    return course;
}

Course<2> ticks(const Object& object, const CoursePlan& plan) {
    Course<2> course{object.name, kTicks.name, hips_of(object, kTicks, plan.seconds),
                     tick_methods(object)};
    append(course.methods, soft_methods(object));
    return course;
}

Course<3> over(const Surface& surface, const CoursePlan& plan) {
    Course<3> course{surface.name, kOver, hand_over(surface, 0.2 * plan.seconds),
                     own_surface_methods(surface)};
    if (plan.peers) {
        append(course.methods, peer_surface_methods(surface));
    }
    course.truths = [surface, hips = course.hips] {
        return truths(surface, hips);
    };
    return course;
}

}  // namespace

std::vector<CourseMaker> courses(const CoursePlan& plan) {
    std::vector<Object> objects = contact_objects();
    std::erase_if(objects, [&](const Object& object) {
        return plan.objects.find(object.name) == std::string::npos;
    });
    std::vector<CourseMaker> all;
    for (const Object& object : objects) {
        std::vector<Path> paths{{"-3..+3 mm", -3e-3, 3e-3}};
        if (object.name == "D") {
            paths.push_back({"0..+3 mm", 0.0, 3e-3});
        }
        for (const Path& path : paths) {
            all.push_back({object.name, path.name, [=] {
                               return closest_points(object, path, plan);
                           }});
        }
    }
    for (const Object& object : objects) {
        all.push_back({object.name, kTicks.name, [=] {
                           return ticks(object, plan);
                       }});
    }
    if (plan.objects.find('S') != std::string::npos) {
        for (const Surface& surface : contact_surfaces()) {
            all.push_back({surface.name, kOver, [=] {
                               return over(surface, plan);
                           }});
        }
    }
    return all;
}

}  // namespace palpate::bench
