#include "tests/stress/surface_cases.hpp"

#include "tests/stress/any_hand.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/surfaces.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;
using namespace palpate::tests;

/// A profile turned about z: balls, rings, tubes, vases with a point or a hole at either end.
SurfaceData turned(Random& random) {
    switch (random.below(4)) {
        case 0:
            return sphere(0.5);
        case 1:
            return torus(0.35, random.in(0.02, 0.3));
        case 2:
            return cylinder(random.in(0.05, 0.5), 1.0);
        default:
            break;
    }
    const int degree = 1 + random.below(4);
    const int count = degree + 1 + random.below(4);
    std::vector<Vec2> profile;
    std::vector<double> weights;
    for (int i = 0; i < count; ++i) {
        profile.push_back({random.in(0.05, 0.5), static_cast<double>(i) / (count - 1) - 0.5});
        weights.push_back(random.decade(-0.5, 0.5));
    }
    profile.front().x = random.coin() ? 0.0 : profile.front().x;
    profile.back().x = random.coin() ? 0.0 : profile.back().x;
    const auto knots = random_knots(random, degree, count - degree - 1, false);
    return revolved(profile, weights, degree, knots);
}

/// One or two edges are a point.
void collapse(SurfaceData& d, Random& random) {
    const bool both = random.coin();
    if (random.coin()) {
        std::fill(d.points.front().begin(), d.points.front().end(), d.points.front().front());
        if (both) {
            std::fill(d.points.back().begin(), d.points.back().end(), d.points.back().front());
        }
        return;
    }
    for (auto& row : d.points) {
        row.front() = d.points.front().front();
        if (both) {
            row.back() = d.points.front().back();
        }
    }
}

/// Rows that fold back along themselves, flat, or that follow each other by a factor.
void degenerate(SurfaceData& d, Random& random) {
    const std::size_t last = d.points.front().size() - 1;
    switch (random.below(4)) {
        case 0:  // the sheet lies on itself
            for (auto& row : d.points) {
                row[last] = row.front();
            }
            break;
        case 1:  // flat
            for (auto& row : d.points) {
                for (Vec3& p : row) {
                    p.y *= 1e-15;
                }
            }
            break;
        case 2: {  // a column that runs away, or comes to rest, by a factor
            const double factor = random.decade(-3.0, 0.8);
            double by = 1.0;
            for (auto& row : d.points) {
                row.front() = by * d.points.front().front();
                by *= factor;
            }
            break;
        }
        default:  // nearly a line
            for (auto& row : d.points) {
                for (Vec3& p : row) {
                    p = Vec3{p.x, 1e-9 * p.y, 1e-9 * p.z};
                }
            }
    }
}

SurfaceData wild_sheet(Random& random) {
    const double decades = std::array<double, 3>{0.0, 1.0, 3.0}.at(random.index(3));
    const int degree = std::array<int, 3>{1, 4, 9}.at(random.index(3));
    SurfaceData d = random_surface(random, 1.0, decades, degree, random.coin());
    const int how = random.below(4);
    if (how == 0) {
        collapse(d, random);
    } else if (how == 1) {
        degenerate(d, random);
    }
    return d;
}

SurfaceData random_data(Random& random, Mood mood) {
    switch (random.below(mood == Mood::gentle ? 3 : 6)) {
        case 0:
            return turned(random);
        case 1: {
            SurfaceData d =
                bicubic_8x8(random, random.coin() ? 0.0 : 0.7, random.decade(-4.0, -1.5));
            for (auto& row : d.points) {
                for (Vec3& p : row) {
                    p = 10.0 * p;
                }
            }
            return d;
        }
        case 2:
            return random_surface(random, 1.0, random.coin() ? 0.0 : 0.3, 5, false);
        default:
            return wild_sheet(random);
    }
}

/// Drawn until no patch is a mere curve, which is refused.
SurfaceData random_data_with_width(Random& random, Mood mood) {
    for (;;) {
        SurfaceData data = random_data(random, mood);
        try {
            static_cast<void>(make_surface(data));
            return data;
        } catch (const std::invalid_argument&) {
        }
    }
}

/// The hand over a surface.
class SpaceHand : public AnyHand<Vec3> {
public:
    SpaceHand(Random& random, const SurfaceCase& c, Mood mood)
        : AnyHand(
              random, c.surface->origin(), c.surface->size(), c.spec.period, mood == Mood::gentle),
          surface_(c.surface.get()) {}

private:
    void falter() override {
        if (!gentle_ && random_->below(4) == 0) {
            path_.push_back(Vec3{std::numeric_limits<double>::quiet_NaN(), at_.y, at_.z});
        }
    }
    [[nodiscard]] Vec2 any_place() {
        const auto& u = surface_->knots_u();
        const auto& v = surface_->knots_v();
        const auto share = [this] {
            return random_->below(6) == 0 ? (random_->coin() ? 0.0 : 1.0) : random_->in(0.0, 1.0);
        };
        const double a = share();
        return {u.front() + a * (u.back() - u.front()),
                v.front() + share() * (v.back() - v.front())};
    }
    [[nodiscard]] Vec3 below(const Vec2& place, double depth) const {
        return surface_->at(place.x, place.y).point - depth * surface_->normal(place.x, place.y);
    }

    void jump() override {
        const Vec2 place = any_place();
        switch (random_->below(4)) {
            case 0:
                go_to(below(place, 0.0));
                break;
            case 1:
                go_to(centre(place));
                break;
            case 2:
                go_to(centre_ +
                      (size_ * random_->decade(0.0, 3.0)) * any_point<Vec3>(*random_, -1.0, 1.0));
                break;
            default:
                go_to(somewhere());
        }
    }
    [[nodiscard]] Vec3 centre(const Vec2& place) {
        const auto bends = tests::principal_curvatures(surface_->at(place.x, place.y),
                                                       surface_->normal(place.x, place.y));
        const double radius = 1.0 / (random_->coin() ? bends.low : bends.high);
        const bool usable = std::isfinite(radius) && std::fabs(radius) < 1e3 * size_;
        return below(place, usable ? radius : random_->in(-0.1, 0.1) * size_);
    }
    void press(int ticks) override {
        const Vec2 place = any_place();
        const Vec3 on = below(place, 0.0);
        const Vec3 from = below(place, -size_ * random_->decade(-4.0, -0.5));
        const Vec3 aim =
            random_->coin() ? centre(place) : below(place, size_ * random_->decade(-4.0, -0.3));
        press_on(on, from, aim, ticks);
    }
    void rub(int ticks) override {
        Vec2 place = any_place();
        const double angle = random_->in(0.0, 2.0 * std::numbers::pi);
        Vec2 way{std::cos(angle), std::sin(angle)};
        const double step = any_step();
        const double deepest =
            size_ * random_->decade(gentle_ ? -5.0 : -6.0, gentle_ ? -1.5 : -0.5);
        const double phase = random_->in(0.0, 6.0);
        const double waves = random_->in(0.0, 20.0);
        const auto& ku = surface_->knots_u();
        const auto& kv = surface_->knots_v();
        for (int i = 0; i < ticks; ++i) {
            const double share = static_cast<double>(i) / ticks;
            go_to(below(place, deepest * (0.7 + std::sin(phase + waves * share))));
            const auto jet = surface_->at(place.x, place.y);
            const double speed = std::max(glm::length(way.x * jet.du + way.y * jet.dv), 1e-300);
            place += std::min(step / speed, 0.3 * (ku.back() - ku.front())) * way;
            const auto reflect = [this](double& at, double lo, double hi, double& rate) {
                if (at < lo || at > hi) {
                    rate = random_->below(3) == 0 ? 0.0 : -rate;
                    at = std::clamp(at, lo, hi);
                }
            };
            reflect(place.x, ku.front(), ku.back(), way.x);
            reflect(place.y, kv.front(), kv.back(), way.y);
        }
    }

    const engine::NurbsSurface* surface_;
};

}  // namespace

SurfaceCase random_surface_case(std::uint64_t seed, Mood mood) {
    Random random(seed);
    SurfaceCase c{.seed = seed,
                  .data = random_data_with_width(random, mood),
                  .pieces = {},
                  .surface = {},
                  .path = {}};
    const double size = random.coin() ? random.decade(-2.0, 0.0) : random.decade(-6.0, 3.0);
    const Vec3 away = random.below(6) == 0
                        ? random.decade(0.0, 2.0) * any_point<Vec3>(random, -1.0, 1.0)
                        : Vec3{};
    for (auto& row : c.data.points) {
        for (Vec3& p : row) {
            p = size * (p + away);
        }
    }
    c.spec.period = random.coin() ? 0.001 : random.decade(-4.0, -2.0);
    c.spec.stiffness = random.coin() ? 1000.0 : random.decade(0.0, 4.0);
    c.law = kLaws.at(random.index(3));
    c.spec.friction = random_friction(random, c.law);
    c.surface = std::make_shared<const engine::NurbsSurface>(make_surface(c.data));
    c.path = SpaceHand(random, c, mood).path(50 + random.index(350));
    return c;
}

std::string scene_text(const SurfaceCase& c) {
    std::string text = fmt::format(
        "# palpate_stress --object surface --seed {}\n[renderer]\nstiffness_n_per_m = {}\n"
        "[friction]\n{}",
        c.seed, c.spec.stiffness, friction_text(c.law, c.spec.friction));
    for (const SurfaceData& d : c.pieces) {
        text += surface_text(d);
    }
    return c.pieces.empty() ? text + surface_text(c.data) : text;
}

std::string path_text(const SurfaceCase& c) {
    return path_text(c.path, c.spec.period);
}

}  // namespace palpate::stress
