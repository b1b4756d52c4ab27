#include "tests/bench/hand.hpp"

#include "tests/support/frame.hpp"

namespace palpate::bench {
namespace {

using namespace palpate::engine;

constexpr double kTick = 1e-3;
constexpr double kTremor = 0.05e-3;  ///< m
constexpr double kTremorRate = 9.0;  ///< Hz

struct Node {
    Vec2 point{};
    Vec2 normal{};
};

/// Rail for the hand: 20 um and 0.02 rad from node to node.
class Rail {
public:
    explicit Rail(const Object& object, bool closed) {
        for (const RationalBezier<2>& span : spans_of(object)) {
            const Node from = node(span, 0.0);
            turn_to(from);
            nodes_.push_back(from);
            follow(span, 0.0, from, 1.0, node(span, 1.0), 0);
        }
        if (closed) {
            turn_to(nodes_.front());
        }
    }

    [[nodiscard]] double last() const { return static_cast<double>(nodes_.size() - 1); }
    [[nodiscard]] Vec2 at(double place, double offset) const {
        const auto i = std::min(static_cast<std::size_t>(place), nodes_.size() - 2);
        const double t = place - static_cast<double>(i);
        const Node& a = nodes_[i];
        const Node& b = nodes_[i + 1];
        return a.point + t * (b.point - a.point) + offset * (a.normal + t * (b.normal - a.normal));
    }

private:
    static Node node(const RationalBezier<2>& span, double u) {
        const Frame frame = engine::frame_at(span, u);
        return {frame.point, frame.normal};
    }
    static double angle(const Vec2& a, const Vec2& b) {
        return std::atan2(engine::cross(a, b), glm::dot(a, b));
    }

    /// The normal turns on the spot at a vertex.
    void turn_to(const Node& next) {
        if (nodes_.empty()) {
            return;
        }
        const Node from = nodes_.back();
        const double turn = angle(from.normal, next.normal);
        const int steps = static_cast<int>(std::fabs(turn) / 0.02);
        for (int i = 1; i <= steps; ++i) {
            const double c = std::cos(turn * i / steps);
            const double s = std::sin(turn * i / steps);
            nodes_.push_back({next.point, c * from.normal + s * engine::perp(from.normal)});
        }
    }

    void follow(const RationalBezier<2>& span,
                double lo,
                const Node& from,
                double hi,
                const Node& to,
                int depth) {
        const bool close = glm::length(to.point - from.point) < 20e-6 &&
                           std::fabs(angle(from.normal, to.normal)) < 0.02;
        if (depth > 3 && (close || depth > 30)) {
            nodes_.push_back(to);
            return;
        }
        const double middle = 0.5 * (lo + hi);
        const Node half = node(span, middle);
        follow(span, lo, from, middle, half, depth + 1);
        follow(span, middle, half, hi, to, depth + 1);
    }

    std::vector<Node> nodes_;
};

/// Slow to and fro between `lo` and `hi`: two incommensurable rates.
double sway(double lo, double hi, double t, double phase) {
    const double tau = 2.0 * std::numbers::pi;
    return 0.5 * (lo + hi) + 0.5 * (hi - lo) *
                                 (0.6 * std::sin(tau * t / 1.7 + phase) +
                                  0.4 * std::sin(tau * t / 0.61 + 2.0 * phase));
}

}  // namespace

std::vector<Vec2> hand_along(const Object& object, const HandPlan& plan) {
    tests::Random random(plan.seed);
    const Rail rail(object, plan.closed);
    const double tau = 2.0 * std::numbers::pi;
    const double phase = random.in(0.0, tau);
    const double pace = random.in(0.0, tau);
    const double shake_x = random.in(0.0, tau);
    const double shake_y = random.in(0.0, tau);

    double place = 0.1 * rail.last();
    double way = 1.0;
    Vec2 hand = rail.at(place, sway(plan.nearest, plan.farthest, 0.0, phase));
    Vec2 before{};
    std::vector<Vec2> path;
    const auto ticks = static_cast<std::size_t>(std::lround(plan.seconds / kTick));
    for (std::size_t i = 0; i < ticks; ++i) {
        const double t = static_cast<double>(i) * kTick;
        const double reach = (0.15 + 0.11 * std::sin(tau * t / 2.9 + pace)) * kTick;
        const double offset = sway(plan.nearest, plan.farthest, t, phase);
        if (random.below(2500) == 0) {
            way = -way;
        }
        // On until the hand has gone its way; beyond a centre of curvature the rail moves, not the
        // hand.
        Vec2 next = rail.at(place, offset);
        for (int step = 0; step < 4000 && glm::length(next - hand) < reach; ++step) {
            place += 0.2 * way;
            if (place < 0.0 || place > rail.last()) {
                if (plan.closed) {
                    place += place < 0.0 ? rail.last() : -rail.last();
                } else {
                    place = std::clamp(place, 0.0, rail.last());
                    way = -way;
                }
            }
            next = rail.at(place, offset);
        }
        hand = next;
        const Vec2 shaken = hand + kTremor * Vec2{std::sin(tau * kTremorRate * t + shake_x),
                                                  std::sin(tau * kTremorRate * t + shake_y)};
        if (i > 0 && glm::length(shaken - before) > kFastestHand * kTick) {
            throw std::logic_error("the hand is too fast");
        }
        before = shaken;
        path.push_back({kEncoderStep * std::round(shaken.x / kEncoderStep),
                        kEncoderStep * std::round(shaken.y / kEncoderStep)});
    }
    return path;
}

}  // namespace palpate::bench
