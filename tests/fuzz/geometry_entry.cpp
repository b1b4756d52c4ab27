#include "engine/rendering/scene.hpp"
#include "engine/surface/surface_closest.hpp"
#include "tests/fuzz/entries.hpp"

namespace palpate::fuzz {
namespace {

using namespace engine;

/// Takes values off the front of the bytes; zeros when they are used up.
class Source {
public:
    explicit Source(Bytes bytes) : rest_(bytes) {}

    std::uint8_t byte() {
        if (rest_.empty()) {
            return 0;
        }
        const std::uint8_t first = rest_.front();
        rest_ = rest_.subspan(1);
        return first;
    }
    int below(int n) { return byte() % n; }
    bool coin() { return (byte() & 1U) != 0U; }

    /// Mostly a plain number in [-1, 1], sometimes any bits at all.
    double number() {
        const std::uint8_t kind = byte();
        if (kind < 200) {
            const int high = byte();
            return (high * 256 + byte()) / 32768.0 - 1.0;
        }
        if (kind < 240) {
            return std::ldexp(1.0 - 2.0 * (kind & 1), byte() - 128);
        }
        std::uint64_t bits = 0;
        for (int i = 0; i < 8; ++i) {
            bits = (bits << 8U) | byte();
        }
        return std::bit_cast<double>(bits);
    }
    double weight() {
        const double w = number();
        return w > 0.0 ? w : 1.0;
    }
    Vec2 point() {
        const double x = number();
        return Vec2{x, number()};
    }

private:
    Bytes rest_;
};

std::vector<double> knots(Source& source, int degree, std::size_t points) {
    const auto p = static_cast<std::size_t>(degree);
    std::vector<double> values(p + 1, 0.0);
    double at = 0.0;
    while (values.size() < points) {
        const double step = source.number();
        at += step > 0.0 ? step : 0.0;
        values.push_back(at);
    }
    at += std::fabs(source.number());
    values.insert(values.end(), p + 1, at);
    return values;
}

NurbsCurve<2> curve(Source& source, const std::optional<Vec2>& start) {
    const int degree = 1 + source.below(kMaxDegree + 1);
    const auto count = static_cast<std::size_t>(degree + 1 + source.below(5));
    std::vector<double> values = knots(source, degree, count);
    std::vector<Vec2> points;
    std::vector<double> weights;
    for (std::size_t i = 0; i < count; ++i) {
        points.push_back(i == 0 && start ? *start : source.point());
        weights.push_back(source.weight());
    }
    return {degree, std::move(values), points, weights};
}

bool finite(const Vec2& v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}

void feel(Source& source, const std::shared_ptr<const Outline>& outline) {
    SceneSpec spec;
    spec.damping = source.coin() ? 0.5 : 0.0;
    if (source.coin()) {
        spec.friction = {.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};
    }
    if (source.coin()) {
        spec.slew = {.speed = 0.2, .radius = 0.003};
    }
    const Scene scene(outline, spec);
    ContactState state;
    for (int i = 0; i < 16; ++i) {
        const Vec2 h = source.point();
        const Contact contact = scene.tick(state, h);
        const bool usual = std::fabs(h.x) < 1e9 && std::fabs(h.y) < 1e9;
        if (!finite(h)) {
            demand(contact.refused && contact.force == Vec2{}, "NaN is refused without force");
        } else if (usual) {
            demand(finite(contact.force) && finite(contact.go), "finite in, finite out");
            demand(contact.normal_force >= 0.0, "the surface only pushes");
            demand(contact.mode != Mode::free || contact.force == Vec2{}, "no force while free");
        }
    }
}

void feel_curves(Source& source) {
    std::vector<NurbsCurve<2>> chain;
    const int count = 1 + source.below(3);
    for (int i = 0; i < count; ++i) {
        std::optional<Vec2> start;
        if (i > 0) {
            start = chain.back().at(chain.back().back()).point;
        }
        chain.push_back(curve(source, start));
        static_cast<void>(chain.back().at(source.number()));
    }
    const Vec2 gap =
        chain.back().at(chain.back().back()).point - chain.front().at(chain.front().front()).point;
    const bool closed = glm::length(gap) <= 1e-9;
    feel(source, std::make_shared<const Outline>(chain, closed));
}

void feel_surface(Source& source) {
    const int degree_u = 1 + source.below(4);
    const int degree_v = 1 + source.below(4);
    const auto rows = static_cast<std::size_t>(degree_u + 1 + source.below(3));
    const auto columns = static_cast<std::size_t>(degree_v + 1 + source.below(3));
    std::vector<double> knots_u = knots(source, degree_u, rows);
    std::vector<double> knots_v = knots(source, degree_v, columns);
    std::vector<std::vector<Vec3>> points(rows);
    std::vector<std::vector<double>> weights(rows);
    for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t j = 0; j < columns; ++j) {
            const Vec2 xy = source.point();
            points[i].push_back(Vec3{xy, source.number()});
            weights[i].push_back(source.weight());
        }
    }
    const SurfaceFeet feet(std::make_shared<const NurbsSurface>(
        degree_u, degree_v, std::move(knots_u), std::move(knots_v), points, weights));
    SurfaceTrack track;
    for (int i = 0; i < 4; ++i) {
        const Vec2 xy = source.point();
        const Vec3 h{xy, source.number()};
        const bool usual = glm::all(glm::lessThan(glm::abs(h), Vec3(1e9)));
        const auto found = feet.track(track, h);
        demand(!usual || std::isfinite(found.distance), "the distance to a surface is finite");
    }
}

}  // namespace

void geometry(Bytes bytes) {
    Source source(bytes);
    try {
        if (source.below(4) == 0) {
            feel_surface(source);
        } else {
            feel_curves(source);
        }
    } catch (const std::invalid_argument&) {
        // what no outline can be made of is refused at the door
    }
}

}  // namespace palpate::fuzz
