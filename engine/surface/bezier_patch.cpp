#include "engine/surface/bezier_patch.hpp"

#include <array>
#include <cstring>
#include <type_traits>

#include "engine/base/processor.hpp"
#include "engine/base/refuse.hpp"

namespace palpate::engine {
namespace {

/// What loops of any length cost against those of a known one, measured.
constexpr Work kUnrolled = 3;

constexpr std::size_t kMaxPoints = kMaxDegree + 1;

template <int N>
using Degree = std::integral_constant<int, N>;

/// For every processor: two coordinates at once.
namespace plain {
using Number = Quad;
inline const Quad& number(const Quad& q) noexcept {
    return q;
}
#include "engine/surface/patch_jets.inl"
}  // namespace plain

#if defined(__x86_64__) && !defined(__clang__)
#pragma GCC push_options
#pragma GCC target("avx2")
/// All four at once.
namespace wide {
struct Number {
    using Four [[gnu::vector_size(32)]] = double;

    Four all;

    [[nodiscard]] double w() const noexcept { return all[3]; }
    [[nodiscard]] Vec3 xyz() const noexcept { return Vec3{all[0], all[1], all[2]}; }

    friend Number operator+(const Number& a, const Number& b) noexcept { return {a.all + b.all}; }
    friend Number operator-(const Number& a, const Number& b) noexcept { return {a.all - b.all}; }
    friend Number operator*(double s, const Number& a) noexcept { return {s * a.all}; }
};
inline const Number& number(const Number& n) noexcept {
    return n;
}
inline Number number(const Quad& q) noexcept {
    Number n;
    static_assert(sizeof n == sizeof q);
    std::memcpy(&n, &q, sizeof n);
    return n;
}
#include "engine/surface/patch_jets.inl"
}  // namespace wide
#pragma GCC pop_options
#else
namespace wide = plain;
#endif

/// The net of a bicubic patch with its differences along u.
std::vector<Quad> with_differences(const std::vector<Quad>& net) {
    std::vector<Quad> all = net;
    for (std::size_t from : {std::size_t{0}, std::size_t{16}}) {
        const std::size_t rows = from == 0 ? 3 : 2;
        for (std::size_t k = 0; k < 4 * rows; ++k) {
            all.push_back(all[from + k + 4] - all[from + k]);
        }
    }
    return all;
}

/// Coefficients of 1, u, u^2, u^3 from Bezier values, by forward differences.
std::array<Quad, 4> powers(const std::array<Quad, 4>& b, int degree) {
    const double n = degree;
    std::array<Quad, 4> c{};
    c[0] = b[0];
    c[1] = n * (b[1] - b[0]);
    if (degree >= 2) {
        c[2] = (0.5 * n * (n - 1.0)) * ((b[2] - b[1]) - (b[1] - b[0]));
    }
    if (degree == 3) {
        c[3] = (b[3] - b[0]) - 3.0 * (b[2] - b[1]);
    }
    return c;
}

void check_degree(int degree, const char* name) {
    refuse_if(degree < 1 || degree > kMaxDegree, "{} is {}: give 1 to {}", name, degree,
              kMaxDegree);
}

}  // namespace

BezierPatch::BezierPatch(int degree_u, int degree_v, std::span<const Quad> net, bool polynomial)
    : degree_u_(degree_u),
      degree_v_(degree_v),
      polynomial_(polynomial),
      net_(net.begin(), net.end()) {
    check_degree(degree_u, "degree_u");
    check_degree(degree_v, "degree_v");
    const auto levels = [](int n) {
        return n * (n + 1) / 2 + 6;
    };
    work_ = 2 * ((degree_v + 1) * levels(degree_u) + 3 * levels(degree_v));
    const auto needed = static_cast<std::size_t>((degree_u + 1) * (degree_v + 1));
    refuse_if(net.size() != needed, "a patch of degree {} x {} needs {} control points, not {}",
              degree_u, degree_v, needed, net.size());
    if (!polynomial || degree_u > 3 || degree_v > 3) {
        method_ = degree_u == 3 && degree_v == 3 ? Method::bicubic
                : degree_u == 2 && degree_v == 2 ? Method::biquadratic
                                                 : Method::any;
        if (method_ == Method::bicubic) {
            prepared_ = with_differences(net_);
        }
        if (method_ == Method::any) {
            work_ *= kUnrolled;
        }
        return;
    }
    method_ = Method::powers;
    std::array<std::array<Quad, 4>, 4> rows{};  // powers of v for each control row
    for (int i = 0; i <= degree_u; ++i) {
        std::array<Quad, 4> line{};
        for (int j = 0; j <= degree_v; ++j) {
            line[static_cast<std::size_t>(j)] = this->net(i, j);
        }
        rows[static_cast<std::size_t>(i)] = powers(line, degree_v);
    }
    prepared_.resize(16);
    for (std::size_t j = 0; j < 4; ++j) {
        const std::array<Quad, 4> column =
            powers({rows[0][j], rows[1][j], rows[2][j], rows[3][j]}, degree_u);
        for (std::size_t i = 0; i < 4; ++i) {
            prepared_[4 * i + j] = column[i];
        }
    }
}

SurfaceJet BezierPatch::at(double u, double v) const noexcept {
    const auto by = [&]<class Jets>(Jets) {
        switch (method_) {
            case Method::powers:
                return Jets::powers(prepared_.data(), u, v);
            case Method::bicubic:
                return Jets::cubic(prepared_.data(), u, v);
            case Method::biquadratic:
                return Jets::cut(net_.data(), Degree<2>{}, Degree<2>{}, u, v);
            default:
                return Jets::cut(net_.data(), degree_u_, degree_v_, u, v);
        }
    };
    return has_avx2() ? by(wide::Jets{}) : by(plain::Jets{});
}

}  // namespace palpate::engine
