#include "data/statistics/solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace palpate::data {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

Eigen::Map<const Vector> vector_of(std::span<const double> v) {
    return {v.data(), static_cast<Eigen::Index>(v.size())};
}

std::vector<double> numbers_of(const Matrix& m) {
    return {m.data(), m.data() + m.size()};
}

double value_at(const SmoothFunction& f, const Vector& at) {
    return f({at.data(), static_cast<std::size_t>(at.size())});
}

Vector gradient_of(const SmoothFunction& f, const Vector& at) {
    constexpr double kStep = 1e-5;  // error 1e-10 of curvature, 1e-8 of rounding
    Vector gradient(at.size());
    Vector moved = at;
    for (Eigen::Index i = 0; i < at.size(); ++i) {
        moved[i] = at[i] + kStep;
        const double above = value_at(f, moved);
        moved[i] = at[i] - kStep;
        gradient[i] = (above - value_at(f, moved)) / (2.0 * kStep);
        moved[i] = at[i];
    }
    return gradient;
}

Matrix hessian_of(const SmoothFunction& f, const Vector& at) {
    constexpr double kStep = 1e-3;
    Matrix hessian(at.size(), at.size());
    const auto moved = [&](Eigen::Index i, double a, Eigen::Index j, double b) {
        Vector point = at;
        point[i] += a;
        point[j] += b;
        return value_at(f, point);
    };
    const double here = value_at(f, at);
    for (Eigen::Index i = 0; i < at.size(); ++i) {
        hessian(i, i) =
            (moved(i, kStep, i, 0.0) - 2.0 * here + moved(i, -kStep, i, 0.0)) / (kStep * kStep);
        for (Eigen::Index j = 0; j < i; ++j) {
            hessian(i, j) = (moved(i, kStep, j, kStep) - moved(i, kStep, j, -kStep) -
                             moved(i, -kStep, j, kStep) + moved(i, -kStep, j, -kStep)) /
                            (4.0 * kStep * kStep);
            hessian(j, i) = hessian(i, j);
        }
    }
    return hessian;
}

using Corner = SimplexMaximum;

bool higher(const Corner& a, const Corner& b) {
    return a.value > b.value;
}

Corner run(const SmoothFunction& value,
           const std::vector<double>& start,
           const std::vector<double>& edge) {
    const auto corner = [&](std::vector<double> point) {
        const double at = value(point);
        return Corner{std::move(point), at};
    };
    std::vector<Corner> all{corner(start)};
    for (std::size_t i = 0; i < start.size(); ++i) {
        std::vector<double> moved = start;
        moved[i] += edge[i];
        all.push_back(corner(std::move(moved)));
    }
    const std::size_t worst = all.size() - 1;
    for (std::size_t step = 0; step < 400 * start.size(); ++step) {
        std::stable_sort(all.begin(), all.end(), higher);
        if (all.front().value - all.back().value < 1e-12) {
            break;
        }
        std::vector<double> middle(start.size(), 0.0);
        for (std::size_t c = 0; c < worst; ++c) {
            for (std::size_t i = 0; i < middle.size(); ++i) {
                middle[i] += all[c].at[i] / static_cast<double>(worst);
            }
        }
        const auto along = [&](double t) {
            std::vector<double> point = middle;
            for (std::size_t i = 0; i < point.size(); ++i) {
                point[i] += t * (all.back().at[i] - middle[i]);
            }
            return corner(std::move(point));
        };
        Corner mirrored = along(-1.0);
        if (higher(mirrored, all.front())) {
            Corner farther = along(-2.0);
            all.back() = higher(farther, mirrored) ? std::move(farther) : std::move(mirrored);
        } else if (higher(mirrored, all[worst - 1])) {
            all.back() = std::move(mirrored);
        } else {
            const bool outside = higher(mirrored, all.back());
            Corner nearer = along(outside ? -0.5 : 0.5);
            if (higher(nearer, outside ? mirrored : all.back())) {
                all.back() = std::move(nearer);
            } else {
                for (std::size_t c = 1; c < all.size(); ++c) {
                    std::vector<double> half = all[c].at;
                    for (std::size_t i = 0; i < half.size(); ++i) {
                        half[i] = 0.5 * (half[i] + all.front().at[i]);
                    }
                    all[c] = corner(std::move(half));
                }
            }
        }
    }
    return *std::min_element(all.begin(), all.end(), higher);
}

}  // namespace

std::vector<double> solve_symmetric(std::span<const double> a, std::span<const double> b) {
    const auto n = static_cast<Eigen::Index>(b.size());
    // Eigen reads the lower half of columns: the upper one of our rows.
    const Matrix matrix = Eigen::Map<const Matrix>(a.data(), n, n);
    const Vector x = matrix.ldlt().solve(vector_of(b));  // as a column: rounded otherwise else
    return {x.begin(), x.end()};
}

Nodes gauss_hermite(int count) {
    Matrix jacobi = Matrix::Zero(count, count);
    for (int i = 1; i < count; ++i) {
        jacobi(i, i - 1) = jacobi(i - 1, i) = std::sqrt(0.5 * i);
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> parts(jacobi);
    const Vector first = parts.eigenvectors().row(0);
    const Vector scaled = std::sqrt(std::numbers::pi) * first;
    return {.at = numbers_of(parts.eigenvalues()),
            .weight = numbers_of(scaled.cwiseProduct(first))};
}

Minimum minimum_near(const SmoothFunction& f, std::span<const double> start) {
    Vector at = vector_of(start);
    double lowest = value_at(f, at);
    bool converged = false;
    Vector gradient = gradient_of(f, at);
    Matrix inverse = Matrix::Identity(at.size(), at.size()) /
                     std::max(1.0, gradient.norm());  // a first step of at most 1
    for (int step = 0; step < 200; ++step) {
        Vector move = -inverse * gradient;
        if (const double longest = move.cwiseAbs().maxCoeff(); longest > 2.0) {
            move *= 2.0 / longest;
        }
        const double slope = gradient.dot(move);
        double share = 1.0;
        double value = value_at(f, at + move);
        while (!(value <= lowest + 1e-4 * share * slope) && share > 1e-10) {
            share *= 0.5;
            value = value_at(f, at + share * move);
        }
        const bool gained = value < lowest;
        if (gained) {
            const Vector s = share * move;
            const Vector next = gradient_of(f, at + s);
            const Vector y = next - gradient;
            at += s;
            lowest = value;
            gradient = next;
            if (const double sy = s.dot(y); sy > 1e-12 * s.norm() * y.norm()) {
                const Matrix turn = Matrix::Identity(s.size(), s.size()) - s * y.transpose() / sy;
                inverse = turn * inverse * turn.transpose() + s * s.transpose() / sy;
            }
        }
        if (gradient.cwiseAbs().maxCoeff() < 1e-6 || !gained) {
            // Where no step gains, rounding is all that is left.
            converged = gradient.cwiseAbs().maxCoeff() < 1e-3;
            break;
        }
    }
    return {.at = numbers_of(at), .value = lowest, .converged = converged};
}

void polish(const SmoothFunction& f, Minimum& best) {
    for (int step = 0; step < 2; ++step) {
        const Vector at = vector_of(best.at);
        const Eigen::LDLT<Matrix> factor(hessian_of(f, at));
        if (factor.info() != Eigen::Success || !factor.isPositive()) {
            return;
        }
        const Vector moved = at - factor.solve(gradient_of(f, at));
        const double value = value_at(f, moved);
        if (!(value <= best.value + 1e-11 * std::fabs(best.value)) ||
            (moved - at).cwiseAbs().maxCoeff() > 0.1) {
            return;
        }
        best.at = numbers_of(moved);
        best.value = value;
    }
}

std::optional<std::vector<double>> inverse_curvature(const SmoothFunction& f,
                                                     std::span<const double> at) {
    const Matrix hessian = hessian_of(f, vector_of(at));
    const Eigen::SelfAdjointEigenSolver<Matrix> parts(hessian);
    if (!(parts.eigenvalues().minCoeff() > 1e-8 * parts.eigenvalues().maxCoeff())) {
        return std::nullopt;
    }
    return numbers_of(hessian.ldlt().solve(Matrix::Identity(hessian.rows(), hessian.cols())));
}

double crossing(const std::function<double(double)>& f,
                double wanted,
                Reading near,
                Reading far,
                double tolerance) {
    for (int i = 0; i < 60; ++i) {
        const double t =
            i % 4 == 3 ? 0.5
                       : std::clamp((wanted - near.value) / (far.value - near.value), 0.02, 0.98);
        const double at = near.at + t * (far.at - near.at);
        const Reading middle{at, f(at)};
        if (std::fabs(middle.value - wanted) < tolerance || at == near.at || at == far.at) {
            return at;
        }
        (middle.value < wanted ? near : far) = middle;
    }
    return 0.5 * (near.at + far.at);
}

SimplexMaximum simplex_maximum(const SmoothFunction& value,
                               std::vector<double> start,
                               std::vector<double> edge) {
    Corner best{std::move(start), -std::numeric_limits<double>::infinity()};
    for (int i = 0; i < 12; ++i) {
        Corner found = run(value, best.at, edge);
        const double gained = found.value - best.value;
        if (gained > 0.0) {
            best = std::move(found);
        }
        if (gained < 1e-9) {
            break;
        }
        for (double& one : edge) {  // another shape than the one that shrank
            one *= -0.7;
        }
    }
    return best;
}

}  // namespace palpate::data
