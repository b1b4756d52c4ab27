#include "engine/friction/first_root.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace palpate::engine {
namespace {

/// Halvings before two roots are one: 2^-50 of a piece is 1e-17 m on a piece of 10 mm.
constexpr int kMaxHalvings = 50;

/// Steps of a bracket: Newton's, and halvings wherever three of them did not halve it.
constexpr int kMaxSteps = 200;

/// From the last step over the root: each nudge is four times the one before.
constexpr int kMaxNudges = 12;

/// What is zero in Twice is zero.
template <class Real>
constexpr bool kSurest = std::is_same_v<Real, Twice>;

enum class Shape : std::uint8_t { above, falls, unclear };

/// Of one polynomial: > 0 throughout, or with one change of sign at most, down.
template <class Real>
Shape shape_of(const Real* c, const double* noise, std::size_t count) noexcept {
    std::size_t i = 0;
    while (i < count && head(c[i]) > noise[i]) {
        ++i;
    }
    if (i == count) {
        return Shape::above;
    }
    const std::size_t unsure = i;
    while (i < count && std::fabs(head(c[i])) <= noise[i]) {
        ++i;
    }
    if (!kSurest<Real> && (i - unsure > 1 || i == count)) {
        return Shape::unclear;
    }
    while (i < count && head(c[i]) < -noise[i]) {
        ++i;
    }
    return i == count ? Shape::falls : Shape::unclear;
}

/// No halving will tell the sign where the stretch begins; in doubles also: where it ends.
template <class Real>
bool ends_in_noise(const ConeNet<Real>& net) noexcept {
    const auto noisy = [&net](std::size_t i) {
        return std::min(std::fabs(head(net.a[i])), std::fabs(head(net.b[i]))) <= net.noise[i];
    };
    return noisy(0) || (!kSurest<Real> && noisy(net.count - 1));
}

/// min(A, B) at a place, its slope, and their rounding.
struct Excess {
    double value;
    double slope;
    double noise;
};

template <class Real>
Excess excess_at(const ConeNet<Real>& net, const Real& z, const Real& rest) noexcept {
    ConeNet<Real> c;
    const std::size_t n = net.count;
    std::copy_n(net.a.data(), n, c.a.data());
    std::copy_n(net.b.data(), n, c.b.data());
    std::copy_n(net.noise.data(), n, c.noise.data());
    const double of_z = head(z);
    const double of_rest = head(rest);
    for (std::size_t left = n - 1; left > 1; --left) {
        for (std::size_t i = 0; i < left; ++i) {
            c.a[i] = rest * c.a[i] + z * c.a[i + 1];
            c.b[i] = rest * c.b[i] + z * c.b[i + 1];
            c.noise[i] = of_rest * c.noise[i] + of_z * c.noise[i + 1];
        }
    }
    const double degree = static_cast<double>(n - 1);
    const Real a = rest * c.a[0] + z * c.a[1];
    const Real b = rest * c.b[0] + z * c.b[1];
    const bool of_a = head(a) < head(b);
    return {.value = head(of_a ? a : b),
            .slope = degree * head(of_a ? c.a[1] - c.a[0] : c.b[1] - c.b[0]),
            .noise = of_rest * c.noise[0] + of_z * c.noise[1]};
}

/// Closes in on the one root of min(A, B) in a net. In the second half of it the place is given by
/// what is left to the end, which has all its digits there.
template <class Real>
class Bracket {
public:
    explicit Bracket(const ConeNet<Real>& net) noexcept : net_(net) {}

    FirstRoot run() noexcept {
        const std::size_t last = net_.count - 1;
        if (std::min(head(net_.a[0]), head(net_.b[0])) <= 0.0) {
            return found(0.0);
        }
        from_end_ = excess_at<Real>(net_, Real(0.5), Real(0.5)).value > 0.0;
        if (from_end_ && std::min(head(net_.a[last]), head(net_.b[last])) > 0.0) {
            return found(0.0);  // beyond the last digit of the end
        }
        outside_ = from_end_ ? 0.5 : 0.0;
        inside_ = from_end_ ? 0.0 : 0.5;
        return found(over(close()));
    }

private:
    Excess at(double s) const noexcept {
        const Real one = Real(1.0) - Real(s);
        return from_end_ ? excess_at<Real>(net_, one, Real(s))
                         : excess_at<Real>(net_, Real(s), one);
    }

    /// Newton's steps, and a halving wherever three of them did not halve the bracket.
    double close() noexcept {
        double s = 0.25;
        double width = 0.5;
        for (int i = 0; i < kMaxSteps; ++i) {
            const Excess e = at(s);
            (e.value > 0.0 ? outside_ : inside_) = s;
            const double now = std::fabs(inside_ - outside_);
            const double slope = from_end_ ? -e.slope : e.slope;
            double next = s - e.value / slope;
            const bool between = (next - outside_) * (next - inside_) < 0.0;
            if (!between && std::fabs(next - s) <= kEpsilon * s) {
                break;
            }
            if (i % 3 == 2) {
                next = now > 0.5 * width ? 0.5 * (inside_ + outside_) : next;
                width = now;
            }
            if (!((next - outside_) * (next - inside_) < 0.0)) {
                next = 0.5 * (inside_ + outside_);
            }
            const double step = std::fabs(next - s);
            s = next;
            if (step <= 0.5 * kEpsilon * s || now <= kEpsilon * s) {
                break;
            }
        }
        return s;
    }

    /// The next place from s on that is in the cone.
    double over(double s) noexcept {
        double nudge = kEpsilon;
        for (int i = 0; i < kMaxNudges; ++i) {
            if (at(s).value <= 0.0) {
                return s;
            }
            s = from_end_ ? s - nudge * s : s + nudge * s;
            if ((s - inside_) * (outside_ - inside_) <= 0.0) {
                break;
            }
            nudge *= 4.0;
        }
        return inside_;
    }

    [[nodiscard]] FirstRoot found(double s) const noexcept {
        const Excess e = at(s);
        FirstRoot root{.answer = FirstRoot::Answer::found, .z = s, .rest = 1.0 - s};
        if (from_end_) {
            std::swap(root.z, root.rest);
        }
        root.blur = e.slope < 0.0 ? -e.noise / e.slope : 1.0;
        return root;
    }

    const ConeNet<Real>& net_;
    bool from_end_ = false;
    double outside_ = 0.0;
    double inside_ = 1.0;
};

/// A stretch on the stack of halvings.
template <class Real>
struct Stretch {
    ConeNet<Real> net;
    double from;   ///< of the whole net
    double width;  ///< a power of 1/2: places are sums without rounding
    int halvings;
};

template <class Real>
FirstRoot placed(const Stretch<Real>& stretch, FirstRoot root) noexcept {
    const double after = 1.0 - (stretch.from + stretch.width);
    root.z = stretch.from + root.z * stretch.width;
    root.rest = after + root.rest * stretch.width;
    root.blur *= stretch.width;
    return root;
}

}  // namespace

template <class Real>
FirstRoot first_root(const ConeNet<Real>& net) noexcept {
    std::array<Stretch<Real>, kMaxHalvings + 2> stack;  // each halving leaves one sibling behind
    stack[0].net = net;
    stack[0].from = 0.0;
    stack[0].width = 1.0;
    stack[0].halvings = 0;
    std::size_t top = 1;
    while (top > 0) {
        Stretch<Real>& at = stack[top - 1];
        const std::size_t n = at.net.count;
        const double* noise = at.net.noise.data();
        const Shape a = shape_of(at.net.a.data(), noise, n);
        const Shape b = shape_of(at.net.b.data(), noise, n);
        if (a == Shape::above && b == Shape::above) {
            --top;
            continue;
        }
        if (a != Shape::unclear && b != Shape::unclear) {
            return placed(at, Bracket<Real>(at.net).run());
        }
        if (at.halvings >= kMaxHalvings || ends_in_noise(at.net)) {
            return kSurest<Real> ? placed(at, {.answer = FirstRoot::Answer::found})
                                 : FirstRoot{.answer = FirstRoot::Answer::unclear};
        }
        Stretch<Real>& left = stack[top];
        left.from = at.from;
        left.width = at.width = 0.5 * at.width;
        left.halvings = at.halvings = at.halvings + 1;
        at.from += at.width;
        halve(at.net, left.net);
        ++top;
    }
    return {};
}

template FirstRoot first_root<double>(const ConeNet<double>&) noexcept;
template FirstRoot first_root<Twice>(const ConeNet<Twice>&) noexcept;

}  // namespace palpate::engine
