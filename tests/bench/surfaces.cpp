#include "tests/bench/surfaces.hpp"

#include "engine/surface/surface_scene.hpp"
#include "tests/figures/thesis/surface_tracker.hpp"
#include "tests/support/surface_cuts.hpp"

namespace palpate::bench {
namespace {

template <class Real>
using Point = std::array<Real, 3>;

template <class Real>
Real dot(const Point<Real>& a, const Point<Real>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Real>
Point<Real> minus(const Point<Real>& a, const Point<Real>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// The four cubic basis functions that are not 0 at t, with two derivatives (The NURBS Book, 2.3).
template <class Real>
struct Basis {
    std::size_t first = 0;
    std::array<std::array<Real, 4>, 3> value{};  ///< [derivative][function]

    Basis(const std::vector<double>& knots, Real t) {
        std::size_t k = 3;
        while (k + 5 < knots.size() && t >= static_cast<Real>(knots[k + 1])) {
            ++k;
        }
        first = k - 3;
        std::array<std::array<Real, 4>, 4> n{};  // [degree][function k - degree + i]
        n[0][0] = 1;
        for (std::size_t p = 1; p <= 3; ++p) {
            for (std::size_t i = 0; i <= p; ++i) {
                const std::size_t at = k - p + i;  // N_at,p from N_at,p-1 and N_at+1,p-1
                if (i > 0) {
                    n[p][i] += (t - knots[at]) / (static_cast<Real>(knots[at + p]) - knots[at]) *
                               n[p - 1][i - 1];
                }
                if (i < p) {
                    n[p][i] += (knots[at + p + 1] - t) /
                               (static_cast<Real>(knots[at + p + 1]) - knots[at + 1]) * n[p - 1][i];
                }
            }
        }
        // From coefficients of degree p to those of the slope, degree p - 1.
        const auto slope = [&](std::size_t p, const std::array<Real, 4>& of) {
            std::array<Real, 4> out{};
            for (std::size_t i = 0; i <= p; ++i) {
                const std::size_t at = k - p + i;
                if (i > 0) {
                    out[i] += static_cast<Real>(p) * of[i - 1] /
                              (static_cast<Real>(knots[at + p]) - knots[at]);
                }
                if (i < p) {
                    out[i] -= static_cast<Real>(p) * of[i] /
                              (static_cast<Real>(knots[at + p + 1]) - knots[at + 1]);
                }
            }
            return out;
        };
        value[0] = n[3];
        value[1] = slope(3, n[2]);
        value[2] = slope(3, slope(2, n[1]));
    }
};

/// S, S_u, S_v, S_uu, S_uv, S_vv.
template <class Real>
std::array<Point<Real>, 6> jet_of(const Surface& surface, Real u, Real v) {
    const Basis<Real> bu(surface.knots_u, u);
    const Basis<Real> bv(surface.knots_v, v);
    constexpr std::array<std::array<std::size_t, 2>, 6> kOrders{
        {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};
    std::array<std::array<Real, 4>, 6> h{};  // homogeneous
    for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t at = (bv.first + j) * surface.columns + bu.first + i;
            const Vec3& p = surface.points[at];
            const Real w = surface.weights[at];
            for (std::size_t d = 0; d < 6; ++d) {
                const Real share = bu.value[kOrders[d][0]][i] * bv.value[kOrders[d][1]][j] * w;
                h[d][0] += share * p.x;
                h[d][1] += share * p.y;
                h[d][2] += share * p.z;
                h[d][3] += share;
            }
        }
    }
    std::array<Point<Real>, 6> s{};
    for (std::size_t c = 0; c < 3; ++c) {  // The NURBS Book, eq. 4.20
        const Real w = h[0][3];
        s[0][c] = h[0][c] / w;
        s[1][c] = (h[1][c] - h[1][3] * s[0][c]) / w;
        s[2][c] = (h[2][c] - h[2][3] * s[0][c]) / w;
        s[3][c] = (h[3][c] - 2 * h[1][3] * s[1][c] - h[3][3] * s[0][c]) / w;
        s[4][c] = (h[4][c] - h[4][3] * s[0][c] - h[1][3] * s[2][c] - h[2][3] * s[1][c]) / w;
        s[5][c] = (h[5][c] - 2 * h[2][3] * s[2][c] - h[5][3] * s[0][c]) / w;
    }
    return s;
}

Vec3 vec(const Point<double>& p) {
    return {p[0], p[1], p[2]};
}

constexpr std::size_t kGrid = 80;

/// Newton's iteration on the square of the distance, inside the domain; an axis that leaves it is
/// held.
Truth<3> refine(const Surface& surface, const Vec3& hip, long double u, long double v) {
    const long double end_u = surface.knots_u.back();
    const long double end_v = surface.knots_v.back();
    const Point<long double> h{hip.x, hip.y, hip.z};
    Truth<3> best{std::numeric_limits<long double>::infinity(), {}};
    for (int i = 0; i < 60; ++i) {
        const auto s = jet_of<long double>(surface, u, v);
        const Point<long double> gap = minus(s[0], h);
        const long double distance = std::sqrt(dot(gap, gap));
        if (distance <= best.distance * (1.0L + 1e-18L)) {  // flat at its minimum: go on
            best = {std::min(distance, best.distance),
                    {static_cast<double>(s[0][0]), static_cast<double>(s[0][1]),
                     static_cast<double>(s[0][2])}};
        }
        const long double gu = dot(gap, s[1]);
        const long double gv = dot(gap, s[2]);
        long double a = dot(s[1], s[1]) + dot(gap, s[3]);
        long double b = dot(s[1], s[2]) + dot(gap, s[4]);
        long double c = dot(s[2], s[2]) + dot(gap, s[5]);
        if (!(a > 0.0L && a * c > b * b)) {  // no minimum here: Gauss and Newton's
            a = dot(s[1], s[1]);
            b = dot(s[1], s[2]);
            c = dot(s[2], s[2]);
        }
        const bool hold_u = (u <= 0.0L && gu > 0.0L) || (u >= end_u && gu < 0.0L);
        const bool hold_v = (v <= 0.0L && gv > 0.0L) || (v >= end_v && gv < 0.0L);
        const long double det = a * c - b * b;
        const long double du = hold_u ? 0.0L : hold_v ? gu / a : (c * gu - b * gv) / det;
        const long double dv = hold_v ? 0.0L : hold_u ? gv / c : (a * gv - b * gu) / det;
        u = std::clamp(u - du, 0.0L, end_u);
        v = std::clamp(v - dv, 0.0L, end_v);
        if (std::fabs(du) + std::fabs(dv) < 1e-19L) {
            break;
        }
    }
    return best;
}

Surface hills(const std::string& name, bool rational) {
    Surface surface;
    surface.name = name;
    surface.columns = surface.rows = 8;
    surface.knots_u = surface.knots_v = {0, 0, 0, 0, 0.2, 0.4, 0.6, 0.8, 1, 1, 1, 1};
    tests::Random random(8);
    for (std::size_t j = 0; j < surface.rows; ++j) {
        for (std::size_t i = 0; i < surface.columns; ++i) {
            surface.points.push_back({0.1 * (static_cast<double>(i) / 7.0 - 0.5),
                                      0.1 * (static_cast<double>(j) / 7.0 - 0.5),
                                      random.in(-0.008, 0.008)});
            const double weight = std::exp(random.in(-0.7, 0.7));
            surface.weights.push_back(rational ? weight : 1.0);
        }
    }
    return surface;
}

tests::SurfaceData data_of(const Surface& surface) {
    std::vector<std::vector<Vec3>> points(surface.columns);
    std::vector<std::vector<double>> weights(surface.columns);
    for (std::size_t i = 0; i < surface.columns; ++i) {
        for (std::size_t j = 0; j < surface.rows; ++j) {
            points[i].push_back(surface.points[j * surface.columns + i]);
            weights[i].push_back(surface.weights[j * surface.columns + i]);
        }
    }
    return {kSurfaceDegree, kSurfaceDegree, surface.knots_u, surface.knots_v, points, weights};
}

/// S and its five derivatives, each evaluation waiting for the one before.
struct SurfaceEvaluation {
    std::shared_ptr<const engine::NurbsSurface> surface;
    engine::SurfacePlace at{.i = 0, .j = 0, .u = 0.4, .v = 0.6};

    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& /*hip*/) {
        const engine::SurfaceJet jet = surface->local_jet(at);
        keep(jet);
        at.u = 0.4 + 1e-30 * jet.point.x;
        return {jet.point, at.u};
    }
};

struct CertifiedSurface {
    std::shared_ptr<const engine::SurfaceFeet> feet;
    engine::SurfaceTrack track{};

    void reset(const Vec3& /*first*/) { track = {}; }
    Answer<3> answer(const Vec3& hip) {
        const engine::SurfaceClosest found = feet->track(track, hip);
        return {found.point, found.distance};
    }
};

/// The thesis' tracker, with its state machine of features where there are several surfaces.
struct ThesisSurface {
    std::shared_ptr<const figures::SurfaceTracker> tracker;
    figures::SurfaceTrackerState state{};

    void reset(const Vec3& first) { state = tracker->start(first); }
    Answer<3> answer(const Vec3& hip) {
        const figures::TrackedSpot found = tracker->step(state, hip, 1e-3);
        return {found.point, found.distance};
    }
};

struct GlobalSurface {
    std::shared_ptr<const engine::SurfaceFeet> feet;

    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& hip) {
        const engine::SurfaceClosest found = feet->closest(hip);
        return {found.point, found.distance};
    }
};

/// A whole tick of a scene in space.
struct SurfaceTick {
    std::shared_ptr<const engine::SurfaceScene> scene;
    engine::SurfaceState state{};

    SurfaceTick(const tests::Pieces& surfaces,
                const engine::Friction& friction,
                bool look_in_contact = true)
        : scene(std::make_shared<const engine::SurfaceScene>(
              surfaces,
              engine::SurfaceSceneSpec{.contact = {.friction = friction},
                                       .look_in_contact = look_in_contact})) {}
    void reset(const Vec3& /*first*/) { state = {}; }
    Answer<3> answer(const Vec3& hip) {
        const engine::SurfaceContact contact = scene->tick(state, hip);
        keep(contact.force);
        return {contact.cp.point, contact.cp.distance};
    }
};

constexpr engine::Friction kFriction{.mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1};

}  // namespace

std::vector<Surface> contact_surfaces() {
    return {hills("bicubic 8x8", false), hills("rational bicubic 8x8", true)};
}

std::vector<Vec3> hand_over(const Surface& surface, double seconds) {
    const double tau = 2.0 * std::numbers::pi;
    const auto at = [&](double phase, double t) {
        const double u = 0.5 + 0.42 * std::sin(phase);
        const double v = 0.5 + 0.42 * std::sin(0.618 * phase + 1.0);
        const auto s = jet_of<double>(surface, u, v);
        const Vec3 normal = glm::normalize(glm::cross(vec(s[1]), vec(s[2])));
        const double offset =
            1.8e-3 * std::sin(tau * t / 1.7) + 1.2e-3 * std::sin(tau * t / 0.61 + 1.0);
        return vec(s[0]) + offset * normal;
    };
    double phase = 0.0;
    Vec3 hand = at(phase, 0.0);
    std::vector<Vec3> path;
    const auto ticks = static_cast<std::size_t>(std::lround(seconds * 1000.0));
    for (std::size_t i = 0; i < ticks; ++i) {
        const double t = 1e-3 * static_cast<double>(i);
        const double reach = 1e-3 * (0.1 + 0.07 * std::sin(tau * t / 2.9));
        Vec3 next = at(phase, t);
        for (int step = 0; step < 4000 && glm::length(next - hand) < reach; ++step) {
            phase += 1e-4;
            next = at(phase, t);
        }
        hand = next;
        Vec3 shaken = hand;
        for (int k = 0; k < 3; ++k) {
            shaken[k] += 0.05e-3 * std::sin(tau * 9.0 * t + 2.1 * k);
            shaken[k] = 1e-5 * std::round(shaken[k] / 1e-5);
        }
        path.push_back(shaken);
    }
    return path;
}

std::vector<Vec3> grid_of(const Surface& surface, std::size_t n) {
    std::vector<Vec3> corners;
    corners.reserve((n + 1) * (n + 1));
    const auto count = static_cast<double>(n);
    for (std::size_t j = 0; j <= n; ++j) {
        for (std::size_t i = 0; i <= n; ++i) {
            const double u = surface.knots_u.back() * static_cast<double>(i) / count;
            const double v = surface.knots_v.back() * static_cast<double>(j) / count;
            corners.push_back(vec(jet_of<double>(surface, u, v)[0]));
        }
    }
    return corners;
}

std::vector<Truth<3>> truths(const Surface& surface, const std::vector<Vec3>& path) {
    const std::vector<Vec3> corners = grid_of(surface, kGrid);
    constexpr std::size_t kRow = kGrid + 1;
    double reach = 0.0;  // no point of the surface is farther from its sample than one mesh
    for (std::size_t i = 0; i + kRow + 1 < corners.size(); ++i) {
        if ((i + 1) % kRow != 0) {
            reach = std::max(reach, glm::length(corners[i + kRow + 1] - corners[i]));
        }
    }
    std::vector<Truth<3>> all;
    std::vector<double> distance(corners.size());
    for (const Vec3& hip : path) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            distance[i] = glm::length(corners[i] - hip);
        }
        const double least = *std::min_element(distance.begin(), distance.end());
        Truth<3> best{std::numeric_limits<long double>::infinity(), {}};
        for (std::size_t j = 0; j < kRow; ++j) {
            for (std::size_t i = 0; i < kRow; ++i) {
                const double here = distance[j * kRow + i];
                bool lowest = here <= least + reach;
                for (std::size_t b = j > 0 ? j - 1 : 0; lowest && b <= std::min(j + 1, kGrid);
                     ++b) {
                    for (std::size_t a = i > 0 ? i - 1 : 0; a <= std::min(i + 1, kGrid); ++a) {
                        lowest = lowest && here <= distance[b * kRow + a];
                    }
                }
                if (lowest) {
                    const Truth<3> found = refine(
                        surface, hip, static_cast<long double>(surface.knots_u.back()) * i / kGrid,
                        static_cast<long double>(surface.knots_v.back()) * j / kGrid);
                    best = found.distance < best.distance ? found : best;
                }
            }
        }
        all.push_back(best);
    }
    return all;
}

Methods<3> own_surface_methods(const Surface& surface) {
    Methods<3> methods;
    const tests::SurfaceData data = data_of(surface);
    const auto made = tests::made(data);
    methods.push_back(make_method<3>("one evaluation", Kind::floor, SurfaceEvaluation{made}));
    const auto feet = std::make_shared<const engine::SurfaceFeet>(made);
    methods.push_back(make_method<3>("certified", Kind::global, CertifiedSurface{feet}));
    methods.push_back(make_method<3>("global, cold", Kind::global, GlobalSurface{feet}));
    methods.push_back(
        make_method<3>("tick, friction", Kind::floor, SurfaceTick({made}, kFriction)));
    methods.push_back(make_method<3>("tick, friction, force only", Kind::floor,
                                     SurfaceTick({made}, kFriction, false)));
    methods.push_back(make_method<3>("tick, frictionless", Kind::floor, SurfaceTick({made}, {})));
    methods.push_back(make_method<3>("tick, frictionless, force only", Kind::floor,
                                     SurfaceTick({made}, {}, false)));
    tests::Random turns(1);  // cut between knots, where no patch of the whole ends
    const tests::Pieces four = tests::made(tests::quarters(data, 0.5, 0.47, turns));
    methods.push_back(make_method<3>("four joined, certified", Kind::global,
                                     CertifiedSurface{std::make_shared<const engine::SurfaceFeet>(
                                         std::make_shared<const engine::SurfaceObject>(four))}));
    methods.push_back(
        make_method<3>("four joined, tick, friction", Kind::floor, SurfaceTick(four, kFriction)));
    methods.push_back(make_method<3>("four joined, tick, friction, force only", Kind::floor,
                                     SurfaceTick(four, kFriction, false)));
    const auto joined = std::make_shared<const engine::SurfaceObject>(four);
    const figures::TrackerSpec feedback{.gain = figures::feedback_gain(*joined, 1.0, 1e-3)};
    const figures::TrackerSpec newton{.kind = figures::TrackerKind::newton};
    methods.push_back(make_method<3>(
        "four joined, thesis feedback", Kind::tracker,
        ThesisSurface{std::make_shared<const figures::SurfaceTracker>(joined, feedback)}));
    methods.push_back(make_method<3>(
        "four joined, thesis newton x1", Kind::tracker,
        ThesisSurface{std::make_shared<const figures::SurfaceTracker>(joined, newton)}));
    return methods;
}

}  // namespace palpate::bench
