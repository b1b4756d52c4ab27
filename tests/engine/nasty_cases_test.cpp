#include "engine/contact/closest_point.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/foot_oracle.hpp"
#include "tests/support/nasty_curves.hpp"

using namespace palpate::engine;

namespace {

/// Every family of curves with every family of queries, so many times.
constexpr std::uint64_t kCases = 27 * kNastyRound;

/// The worst of 100,000 seeds, one a pair of families, for a solver that took one rounding level
/// for a whole span and knew only u, not 1 - u: it was wrong there by 0.25 of the size down to
/// 1e-12.
constexpr std::array<std::uint64_t, 36> kWorst{
    14226, 30527, 69021, 37139, 86862, 57526, 19146, 86444, 60016, 95812, 80288, 35582,
    83803, 89485, 38964, 41547, 54012, 8500,  19318, 96420, 81144, 26885, 55822, 49850,
    3827,  66907, 8366,  87369, 17012, 94332, 85754, 98370, 75020, 97378, 58611, 33922};

/// The code under test: distance from `h` to the whole curve, m.
double closest(const NurbsData<2>& data, const Vec2& h) {
    const NurbsCurve<2> curve(data.degree, data.knots, data.points, data.weights);
    std::vector<RationalBezier<2>> spans;
    for (const auto& span : balanced_spans(curve, 0)) {
        spans.push_back(span.curve);
    }
    return std::sqrt(PieceTree<2>(std::move(spans)).closest(h).distance2);
}

/// Of u, dense at both ends, where steep weights hide a curve.
std::vector<long double> samples() {
    std::vector<long double> shares;
    for (int i = 0; i <= 300; ++i) {
        shares.push_back(i / 300.0L);
    }
    for (int i = 1; i <= 100; ++i) {
        shares.push_back(std::exp2(-8.0L - 0.25L * i));
        shares.push_back(1.0L - shares.back());
    }
    return shares;
}

}  // namespace

TEST_CASE("the oracle proves its distance, and no sample of the curve beats it") {
    for (std::uint64_t seed = 0; seed < kCases; seed += 40) {
        const NastyCase nasty = nasty_case(seed);
        const FootOracle oracle(nasty.curve);
        const OracleFoot found = oracle.closest(nasty.query);
        // The definition is evaluated in world coordinates, which have their own last bit.
        const Vec2 last = nasty.curve.points.back();
        const long double scale = std::max(
            {oracle.size(), found.distance, std::hypot(static_cast<long double>(last.x), last.y)});
        long double sampled = std::numeric_limits<long double>::infinity();
        for (const long double share : samples()) {
            const auto from = static_cast<long double>(nasty.curve.knots.front());
            const auto to = static_cast<long double>(nasty.curve.knots.back());
            const auto p =
                nurbs_point(nasty.curve, share == 1.0L ? to : from + (to - from) * share);
            sampled = std::min(sampled, std::hypot(p[0] - nasty.query.x, p[1] - nasty.query.y));
        }
        // And it is the distance of a point of the curve: 1e-11 for steep weights, where u is
        // coarse.
        const auto foot = nurbs_point(nasty.curve, found.u);
        const long double there = std::hypot(foot[0] - nasty.query.x, foot[1] - nasty.query.y);
        const bool holds = std::fabs(there - found.distance) <= 1e-11L * scale &&
                           found.distance - found.proved <= 2e-17L * scale &&
                           found.distance <= sampled + 2e-17L * scale;
        if (!holds) {
            UNSCOPED_INFO(text_of(nasty));
            UNSCOPED_INFO("gap " << static_cast<double>((found.distance - found.proved) / scale)
                                 << ", above a sample by "
                                 << static_cast<double>((found.distance - sampled) / scale));
        }
        CHECK(holds);
    }
}

TEST_CASE("no nasty query is answered wrongly") {
    constexpr double kUlp = std::numeric_limits<double>::epsilon();
    int above_16_ulp = 0;
    double worst = 0.0;
    std::string failures;
    std::vector<std::uint64_t> seeds(kWorst.begin(), kWorst.end());
    for (std::uint64_t seed = 0; seed < kCases; seed += 3) {
        seeds.push_back(seed);
    }
    for (const std::uint64_t seed : seeds) {
        const NastyCase nasty = nasty_case(seed);
        const FootOracle oracle(nasty.curve);
        const long double exact = oracle.closest(nasty.query).distance;
        const long double scale = std::max(oracle.size(), exact);
        const long double gap = std::fabs(closest(nasty.curve, nasty.query) - exact);
        const auto error = static_cast<double>(scale > 0.0L ? gap / scale : gap);
        worst = std::max(worst, error);
        if (!(error <= 16.0 * kUlp)) {
            ++above_16_ulp;
            failures += "error " + std::to_string(error / kUlp) + " ulp, " + text_of(nasty) + "\n";
        }
    }
    WARN(seeds.size() << " nasty queries: worst error " << worst << " of the size or distance, "
                      << above_16_ulp << " above 16 ulp");
    INFO(failures);
    CHECK(above_16_ulp == 0);
}
