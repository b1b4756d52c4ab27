#include <Eigen/LU>

#include "engine/deformation/dnurbs.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/runge_kutta.hpp"
#include "tests/support/surface_oracle.hpp"

using namespace palpate::engine;

namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

Eigen::Index at(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

/// The cubic of the thesis' Figure 4.4.1, both ends held.
DnurbsSpec bow() {
    return {.degree = 3,
            .knots = {0, 0, 0, 0, 1, 1, 1, 1},
            .points = {{0.0, 0.0}, {0.03, 0.05}, {0.07, 0.05}, {0.1, 0.0}},
            .mu = 0.1,
            .gamma = 0.5,
            .alpha = 10.0,
            .beta = 0.5,
            .fixed = {0, 3}};
}

/// Degree 1 to 5, one to four pieces of different lengths, one to three points held.
DnurbsSpec random_curve(Random& random, bool rational) {
    DnurbsSpec spec{.degree = 1 + random.below(5)};
    const auto p = static_cast<std::size_t>(spec.degree);
    std::vector<double> inner;
    for (int i = random.below(4); i > 0; --i) {
        inner.push_back(0.2 * (static_cast<double>(inner.size()) + random.in(0.3, 1.0)));
    }
    spec.knots.assign(p + 1, 0.0);
    spec.knots.insert(spec.knots.end(), inner.begin(), inner.end());
    spec.knots.insert(spec.knots.end(), p + 1, 1.0);
    for (std::size_t i = 0; i < p + 1 + inner.size(); ++i) {
        spec.points.push_back(random.point(-0.1, 0.1));
        if (rational) {
            spec.weights.push_back(random.in(0.5, 2.0));
        }
    }
    spec.mu = random.decade(-2.0, 0.0);
    spec.gamma = random.decade(-1.0, 1.0);
    spec.alpha = random.decade(0.0, 2.0);
    spec.beta = random.decade(-3.0, 0.0);
    spec.fixed = {0};
    if (spec.points.size() > 2 && random.coin()) {
        spec.fixed.push_back(spec.points.size() - 1);
    }
    return spec;
}

/// All rational basis functions, a row each, and their first two derivatives beside them.
LongMatrix rational_basis(const DnurbsSpec& spec, long double u) {
    const std::size_t n = spec.points.size();
    const auto splines = basis_jet(spec.knots, knot_piece(spec.knots, u), spec.degree, n, u);
    LongMatrix r(n, 3);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            r(at(i), at(k)) = (spec.weights.empty() ? 1.0L : spec.weights[i]) * splines[k][i];
        }
    }
    const Eigen::RowVector3<long double> whole = r.colwise().sum();
    r.col(0) /= whole(0);
    r.col(1) = (r.col(1) - r.col(0) * whole(1)) / whole(0);
    r.col(2) = (r.col(2) - 2.0L * r.col(1) * whole(1) - r.col(0) * whole(2)) / whole(0);
    return r;
}

struct Matrices {
    LongMatrix gram, stiffness;
};

/// By the 5-point rule (Abramowitz & Stegun 25.4.30, its closed form) on sixty parts of each piece.
Matrices oracle_of(const DnurbsSpec& spec) {
    const Eigen::Index n = at(spec.points.size());
    Matrices m{LongMatrix::Zero(n, n), LongMatrix::Zero(n, n)};
    const long double near = std::sqrt(5.0L - 2.0L * std::sqrt(10.0L / 7.0L)) / 3.0L;
    const long double far = std::sqrt(5.0L + 2.0L * std::sqrt(10.0L / 7.0L)) / 3.0L;
    const long double heavy = (322.0L + 13.0L * std::sqrt(70.0L)) / 900.0L;
    const long double light = (322.0L - 13.0L * std::sqrt(70.0L)) / 900.0L;
    const std::array<std::pair<long double, long double>, 5> rule{
        {{0.0L, 128.0L / 225.0L}, {near, heavy}, {-near, heavy}, {far, light}, {-far, light}}};
    constexpr int kParts = 60;
    for (std::size_t k = 0; k + 1 < spec.knots.size(); ++k) {
        const long double width =
            (static_cast<long double>(spec.knots[k + 1]) - spec.knots[k]) / kParts;
        for (int part = 0; width > 0.0L && part < kParts; ++part) {
            for (const auto& [place, weight] : rule) {
                const long double u = spec.knots[k] + width * (part + 0.5L * (1.0L + place));
                const LongMatrix r = rational_basis(spec, u);
                const long double share = 0.5L * width * weight;
                m.gram += share * r.col(0) * r.col(0).transpose();
                m.stiffness += share * spec.alpha * r.col(1) * r.col(1).transpose() +
                               share * spec.beta * r.col(2) * r.col(2).transpose();
            }
        }
    }
    return m;
}

/// Largest distance between displacements, over the largest displacement.
double relative_error(const std::vector<Vec2>& found, const std::vector<Vec2>& exact) {
    double worst = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        worst = std::max(worst, glm::length(found[i] - exact[i]));
        size = std::max(size, glm::length(exact[i]));
    }
    return worst / size;
}

/// By elimination with pivots in long double; the curve itself has a factor of Cholesky's.
std::vector<Vec2> exact_rest(const DnurbsSpec& spec, double u, const Vec2& force) {
    std::vector<Eigen::Index> moving;
    for (std::size_t i = 0; i < spec.points.size(); ++i) {
        if (std::find(spec.fixed.begin(), spec.fixed.end(), i) == spec.fixed.end()) {
            moving.push_back(at(i));
        }
    }
    const LongMatrix k = oracle_of(spec).stiffness(moving, moving);
    const LongMatrix unit = k.partialPivLu().solve(rational_basis(spec, u)(moving, 0));
    std::vector<Vec2> q(spec.points.size());
    for (std::size_t i = 0; i < moving.size(); ++i) {
        q[static_cast<std::size_t>(moving[i])] = static_cast<double>(unit(at(i), 0)) * force;
    }
    return q;
}

/// The motion of the bow's two free points, in steps of 10 us: M and D are multiples of one matrix.
std::vector<Vec2> fine_motion(const DnurbsSpec& spec, double u, const Vec2& force, double time) {
    using Two = Eigen::Vector2<long double>;
    using State = Eigen::Vector4<long double>;  // q1, q2, v1, v2 along the force
    const Matrices m = oracle_of(spec);
    const Eigen::Matrix2<long double> gram = m.gram.block<2, 2>(1, 1);
    const Eigen::Matrix2<long double> stiffness = m.stiffness.block<2, 2>(1, 1);
    const Two load = rational_basis(spec, u).block<2, 1>(1, 0);
    const auto slope = [&](const State& y, long double /*t*/) {
        const Two v = y.tail<2>();
        const Two side = load - spec.gamma * (gram * v) - stiffness * y.head<2>();
        State out;
        out << v, gram.inverse() * side / spec.mu;
        return out;
    };
    State y = State::Zero();
    for (int step = 0; step < static_cast<int>(std::lround(time / 1e-5)); ++step) {
        y = runge_kutta(y, 1e-5L, slope);
    }
    return {{}, static_cast<double>(y(0)) * force, static_cast<double>(y(1)) * force, {}};
}

std::vector<Vec2> stepped(const Dnurbs& curve, double u, const Vec2& force, double h, double time) {
    DnurbsMotion motion(curve, h);
    const BasisAt where = curve.basis(u);
    for (int step = 0; step < static_cast<int>(std::lround(time / h)); ++step) {
        motion.advance(where, force);
    }
    return motion.displacements();
}

/// v^T M v / 2 + q^T K q / 2, and v^T D v.
struct Energy {
    double held = 0.0;
    double loss = 0.0;  ///< W
};
Energy energy_of(const Dnurbs& curve, const std::vector<Vec2>& q, const std::vector<Vec2>& v) {
    Energy e;
    for (std::size_t i = 0; i < q.size(); ++i) {
        for (std::size_t j = 0; j < q.size(); ++j) {
            e.held += 0.5 * curve.mass(i, j) * glm::dot(v[i], v[j]) +
                      0.5 * curve.stiffness(i, j) * glm::dot(q[i], q[j]);
            e.loss += curve.damping(i, j) * glm::dot(v[i], v[j]);
        }
    }
    return e;
}

}  // namespace

TEST_CASE(
    "a curve rests where an independent method says, whatever degree, knots, weights and load") {
    double worst_polynomial = 0.0;
    double worst_rational = 0.0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const bool rational = seed % 2 == 1;
        const DnurbsSpec spec = random_curve(random, rational);
        const double u = random.in(0.0, 1.0);
        const Vec2 force = random.point(-2.0, 2.0);
        const double error =
            relative_error(Dnurbs(spec).equilibrium(u, force), exact_rest(spec, u, force));
        double& worst = rational ? worst_rational : worst_polynomial;
        worst = std::max(worst, error);
    }
    CHECK(worst_polynomial < 1e-12);
    CHECK(worst_rational < 1e-11);
}

TEST_CASE("a step of 1 ms is within 2e-3 of the motion, and half of it is four times as near") {
    const DnurbsSpec spec = bow();
    const Dnurbs curve(spec);
    for (const double u : {0.5, 0.3}) {
        const std::vector<Vec2> exact = fine_motion(spec, u, {0.4, -1.0}, 0.1);
        const double at_1_ms = relative_error(stepped(curve, u, {0.4, -1.0}, 1e-3, 0.1), exact);
        const double at_half = relative_error(stepped(curve, u, {0.4, -1.0}, 5e-4, 0.1), exact);
        CAPTURE(u, at_1_ms, at_half);
        CHECK(at_1_ms < 2e-3);
        CHECK(at_1_ms / at_half == Approx(4.0).epsilon(0.05));
    }
}

TEST_CASE("a motion keeps its books: energy held is work done less what damping took") {
    SEEDED(random, std::uint64_t{40});
    const Dnurbs curve(random_curve(random, random.coin()));
    DnurbsMotion motion(curve, random.decade(-4.0, -1.0));
    double books = 0.0;
    double turned_over = 0.0;
    double before_release = 0.0;
    for (int step = 0; step < 200; ++step) {
        const bool free = step >= 100;
        const BasisAt where = curve.basis(random.in(0.0, 1.0));
        const Vec2 force = free ? Vec2{} : random.point(-1.0, 1.0);
        const std::vector<Vec2> q = motion.displacements();
        std::vector<Vec2> mean = motion.velocities();
        motion.advance(where, force);
        double work = 0.0;
        for (std::size_t i = 0; i < where.value.size(); ++i) {
            work += where.value[i] *
                    glm::dot(force, motion.displacements()[where.first + i] - q[where.first + i]);
        }
        for (std::size_t i = 0; i < mean.size(); ++i) {
            mean[i] = 0.5 * (mean[i] + motion.velocities()[i]);
        }
        const double loss = motion.step() * energy_of(curve, q, mean).loss;
        books += work - loss;
        turned_over += std::fabs(work) + loss;
        const double held = energy_of(curve, motion.displacements(), motion.velocities()).held;
        REQUIRE(std::fabs(held - books) < 1e-10 * turned_over);
        REQUIRE((!free || step == 100 || held <= before_release * (1.0 + 1e-12)));
        before_release = held;
    }
}

TEST_CASE(
    "a motion under a steady force comes to rest at the equilibrium, and a step allocates "
    "nothing") {
    const Dnurbs curve(bow());
    DnurbsMotion motion(curve, 1e-3);
    const BasisAt where = curve.basis(0.3);
    const std::size_t before = allocations();
    for (int step = 0; step < 20'000; ++step) {
        motion.advance(where, {0.5, -1.0});
    }
    CHECK(allocations() == before);
    CHECK(relative_error(motion.displacements(), curve.equilibrium(0.3, {0.5, -1.0})) < 1e-9);
}

TEST_CASE("the slowest motion of a bow is the one that its closed form says") {
    SEEDED(random, 20U, 2908U);
    DnurbsSpec spec = bow();
    spec.alpha = random.decade(-2.0, 2.0);
    spec.beta = random.decade(-2.0, 2.0);
    spec.mu = random.decade(-300.0, 3.0);
    // One cubic span, both ends fixed: the inner points move alike, by 3 u (1 - u), or against each
    // other, by 3 u (1 - u) (1 - 2 u), which is faster. Of the first the integrals of f^2, f'^2 and
    // f''^2 are 3/10, 3 and 36.
    const double omega =
        std::sqrt((3.0 * spec.alpha + 36.0 * spec.beta) / 0.3) / std::sqrt(spec.mu);
    CHECK(Dnurbs(spec).slowest_motion() == Approx(omega).epsilon(1e-6));
    spec.fixed.clear();
    CHECK(Dnurbs(spec).slowest_motion() == 0.0);
}

TEST_CASE("a curve that cannot be, or that nothing holds, is refused with what to do") {
    const auto refused = [](const char* words, const auto& change) {
        DnurbsSpec spec = bow();
        change(spec);
        CHECK_THROWS_WITH(Dnurbs(spec).equilibrium(0.5, {0.0, 1.0}), Has(words));
    };
    refused("fixed has 4: control points count from 0 to 3", [](auto& s) { s.fixed = {4}; });
    refused("fixed has 3 twice", [](auto& s) { s.fixed = {3, 0, 3}; });
    refused("every control point", [](auto& s) { s.fixed = {0, 1, 2, 3}; });
    refused("alpha is -1", [](auto& s) { s.alpha = -1.0; });
    refused("mu is nan", [](auto& s) { s.mu = std::nan(""); });
    refused("fixed leaves a motion", [](auto& s) { s.fixed.clear(); });
    refused("fixed leaves a motion", [](auto& s) { s.alpha = s.beta = 0.0; });
    refused("fixed leaves a motion", [](auto& s) { s.alpha = 0.0, s.fixed = {0}; });
    DnurbsSpec light = bow();
    light.mu = 0.0;
    CHECK_THROWS_WITH(DnurbsMotion(Dnurbs(light), 1e-3), Has("a motion needs mass"));
    CHECK_THROWS_WITH(DnurbsMotion(Dnurbs(bow()), 0.0), Has("dt_s is 0"));
}
