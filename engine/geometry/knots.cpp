#include "engine/geometry/knots.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/base/text.hpp"

namespace palpate::engine {
namespace {

void check_degree(int degree, std::size_t points) {
    if (degree < 1 || degree > kMaxDegree) {
        throw std::invalid_argument("degree is " + std::to_string(degree) + ": give 1 to " +
                                    std::to_string(kMaxDegree));
    }
    const auto p = static_cast<std::size_t>(degree);
    if (points < p + 1) {
        throw std::invalid_argument("degree " + std::to_string(degree) + " needs at least " +
                                    std::to_string(p + 1) + " control points, not " +
                                    std::to_string(points) + ": add points or lower the degree");
    }
}

void check_values(const std::vector<double>& values, const std::string& name) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            throw std::invalid_argument(name + "[" + std::to_string(i) + "] is " +
                                        number_text(values[i]) + ": give a finite number");
        }
        if (i > 0 && values[i] < values[i - 1]) {
            throw std::invalid_argument(name + "[" + std::to_string(i) + "] = " +
                                        number_text(values[i]) + " is below the knot before it, " +
                                        number_text(values[i - 1]) + ": knots never fall");
        }
    }
}

void check_clamped(const std::vector<double>& values, std::size_t p, const std::string& name) {
    const std::size_t last = values.size() - 1;
    for (std::size_t i = 1; i <= p; ++i) {
        if (values[i] != values[0] || values[last - i] != values[last]) {
            throw std::invalid_argument(
                name + " must repeat its first and its last value " + std::to_string(p + 1) +
                " times (degree + 1), so that the curve reaches its end points");
        }
    }
    if (!(values[0] < values[last])) {
        throw std::invalid_argument(name + " holds only the value " + number_text(values[0]) +
                                    ": the last knot must be larger than the first");
    }
}

void check_repeats(const std::vector<double>& values, std::size_t p, const std::string& name) {
    for (std::size_t i = 1; i + p < values.size() - 1; ++i) {
        if (values[i] > values[0] && values[i] < values.back() && values[i] == values[i + p]) {
            throw std::invalid_argument(name + " repeats the inner knot " + number_text(values[i]) +
                                        " more than " + std::to_string(p) +
                                        " times (the degree): the curve would fall apart");
        }
    }
}

}  // namespace

KnotVector::KnotVector(std::vector<double> values,
                       int degree,
                       std::size_t points,
                       std::string_view name)
    : values_(std::move(values)), degree_(degree) {
    const std::string label(name);
    check_degree(degree, points);
    const auto p = static_cast<std::size_t>(degree);
    if (values_.size() != points + p + 1) {
        throw std::invalid_argument(label + " has " + std::to_string(values_.size()) +
                                    " values: " + std::to_string(points) +
                                    " control points of degree " + std::to_string(degree) +
                                    " need " + std::to_string(points + p + 1));
    }
    check_values(values_, label);
    check_clamped(values_, p, label);
    check_repeats(values_, p, label);
    for (std::size_t i = p; i < points; ++i) {
        if (values_[i] < values_[i + 1]) {
            intervals_.push_back({values_[i], values_[i + 1], i});
        }
    }
}

std::size_t KnotVector::interval_of(double u) const noexcept {
    const auto after =
        std::upper_bound(intervals_.begin(), intervals_.end(), u,
                         [](double value, const Interval& piece) { return value < piece.lo; });
    return after == intervals_.begin() ? 0
                                       : static_cast<std::size_t>(after - intervals_.begin()) - 1;
}

}  // namespace palpate::engine
