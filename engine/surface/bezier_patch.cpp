#include "engine/surface/bezier_patch.hpp"

#include <array>
#include <cstring>
#include <type_traits>

#include "engine/base/processor.hpp"
#include "engine/base/refuse.hpp"
#include "engine/math/bernstein.hpp"

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
inline void put(const Quad& q, char* to) noexcept {
    std::memcpy(to, &q, sizeof q);
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
inline void put(const Number& n, char* to) noexcept {
    using Stored [[gnu::vector_size(32), gnu::aligned(16), gnu::may_alias]] = double;
    *reinterpret_cast<Stored*>(to) = n.all;
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
    jet_ = has_avx2() ? jet_by<wide::Jets>() : jet_by<plain::Jets>();
    if (!polynomial || degree_u > 3 || degree_v > 3) {
        const bool bicubic = degree_u == 3 && degree_v == 3;
        const bool known = bicubic || (degree_u == 2 && degree_v == 2);
        prepared_ = bicubic ? with_differences(net_) : net_;
        work_ *= known ? Work{1} : kUnrolled;
        return;
    }
    std::array<std::array<Quad, 4>, 4> rows{};  // powers of v for each control row
    const auto row = static_cast<std::size_t>(degree_v) + 1;
    for (std::size_t i = 0; i * row < net_.size(); ++i) {
        rows[i] = powers(std::span<const Quad>(net_).subspan(i * row, row), degree_v);
    }
    prepared_.resize(16);
    for (std::size_t j = 0; j < 4; ++j) {
        const std::array<Quad, 4> column{rows[0][j], rows[1][j], rows[2][j], rows[3][j]};
        const std::array<Quad, 4> power = powers(std::span<const Quad>(column), degree_u);
        for (std::size_t i = 0; i < 4; ++i) {
            prepared_[4 * i + j] = power[i];
        }
    }
}

template <class Jets>
BezierPatch::Jet BezierPatch::jet_by() const noexcept {
    return polynomial_ && degree_u_ <= 3 && degree_v_ <= 3 ? Jets::powers
         : degree_u_ == 3 && degree_v_ == 3                ? Jets::cubic
         : degree_u_ == 2 && degree_v_ == 2                ? Jets::square
                                                           : Jets::any;
}

}  // namespace palpate::engine
