#pragma once

#include <variant>

#include "tests/bench/errors.hpp"

namespace palpate::bench {

/// An object, a hand along it, and the methods that follow the hand: one table of `contact`.
template <int D>
struct Course {
    std::string object;  ///< "A"
    std::string path;    ///< "-3..+3 mm"
    std::vector<Vec<D>> hips;
    Methods<D> methods;
    std::function<std::vector<Truth<D>>()> truths{};  ///< none where no method has an error
};

using AnyCourse = std::variant<Course<2>, Course<3>>;

struct CoursePlan {
    std::string objects = "ABCDES";  ///< letters; S: surfaces
    double seconds = 20.0;           ///< of the hand; on surfaces a fifth of it
    bool peers = false;
};

struct CourseMaker {
    std::string object;
    std::string path;
    std::function<AnyCourse()> make;
};

/// All courses of `contact`.
[[nodiscard]] std::vector<CourseMaker> courses(const CoursePlan& plan);

}  // namespace palpate::bench
