// SINTEF Spline Library 4.6 (Debian's libsisl-dev), GNU AGPL: linked into this benchmark alone.

#include <sisl.h>

#include "tests/bench/peers/peers.hpp"

namespace palpate::bench {
namespace {

/// Geometric resolution, of the size of a model: of 1e-6 to 1e-12 the one with the fewest wrong
/// answers.
constexpr double kResolution = 1e-12;
constexpr double kComputing = 1e-15;  // the library reads it no longer

constexpr int kPolynomial = 1;
constexpr int kRational = 2;
constexpr int kCopied = 1;

using CurvePointer = std::shared_ptr<SISLCurve>;
using SurfacePointer = std::shared_ptr<SISLSurf>;

template <int D>
double resolution_of(const std::vector<Vec<D>>& points) {
    const engine::Box<D> box = engine::box_of<D>(points);
    const double size = glm::length(box.size());
    return kResolution * (size > 0.0 ? size : 1.0);
}

CurvePointer sisl_curve(const tests::NurbsData<2>& data) {
    bool polynomial = true;
    for (const double w : data.weights) {
        polynomial = polynomial && w == data.weights.front();
    }
    std::vector<double> knots = data.knots;
    std::vector<double> coefficients;  // x y, or w x, w y, w
    for (std::size_t i = 0; i < data.points.size(); ++i) {
        const double w = polynomial ? 1.0 : data.weights[i];
        coefficients.push_back(w * data.points[i].x);
        coefficients.push_back(w * data.points[i].y);
        if (!polynomial) {
            coefficients.push_back(w);
        }
    }
    const CurvePointer curve(
        newCurve(static_cast<int>(data.points.size()), data.degree + 1, knots.data(),
                 coefficients.data(), polynomial ? kPolynomial : kRational, 2, kCopied),
        freeCurve);
    if (curve == nullptr) {
        throw std::runtime_error("SISL takes no such curve");
    }
    return curve;
}

Vec2 point_at(SISLCurve* curve, double u) {
    std::array<double, 2> point{};
    int left = 0;
    int status = 0;
    s1221(curve, 0, u, &left, point.data(), &status);
    return {point[0], point[1]};
}

/// The nearest of the answers of all curves.
struct Nearest {
    Vec2 hip{};
    Answer<2> best{{}, std::numeric_limits<double>::infinity()};

    bool offer(SISLCurve* curve, double u) {
        const Vec2 foot = point_at(curve, u);
        const double distance = glm::length(foot - hip);
        if (distance < best.distance) {
            best = {foot, distance};
            return true;
        }
        return false;
    }
};

struct OneClosest {
    std::vector<CurvePointer> curves;
    double resolution = kResolution;

    void reset(const Vec2& /*first*/) {}
    Answer<2> answer(const Vec2& hip) const {
        Nearest nearest{.hip = hip};
        for (const CurvePointer& curve : curves) {
            std::array<double, 2> point{hip.x, hip.y};
            double u = 0.0;
            double distance = 0.0;
            int status = 0;
            s1957(curve.get(), point.data(), 2, kComputing, resolution, &u, &distance, &status);
            if (status >= 0 && distance < nearest.best.distance) {
                nearest.offer(curve.get(), u);
            }
        }
        return nearest.best;
    }
};

struct AllClosest {
    std::vector<CurvePointer> curves;
    double resolution = kResolution;

    void reset(const Vec2& /*first*/) {}
    Answer<2> answer(const Vec2& hip) const {
        Nearest nearest{.hip = hip};
        for (const CurvePointer& curve : curves) {
            std::array<double, 2> point{hip.x, hip.y};
            int count = 0;
            int arcs = 0;
            int status = 0;
            double* u = nullptr;
            SISLIntcurve** arc = nullptr;
            s1953(curve.get(), point.data(), 2, kComputing, resolution, &count, &u, &arcs, &arc,
                  &status);
            for (int i = 0; status >= 0 && i < count; ++i) {
                nearest.offer(curve.get(), u[i]);
            }
            for (int i = 0; status >= 0 && i < arcs; ++i) {  // equally near all along
                nearest.offer(curve.get(), arc[i]->epar1[0]);
            }
            std::free(u);
            if (arc != nullptr) {
                freeIntcrvlist(arc, arcs);
            }
        }
        return nearest.best;
    }
};

/// Newton's iteration from the parameter of the tick before, on each curve.
struct WarmLocal {
    std::vector<CurvePointer> curves;
    double resolution = kResolution;
    std::vector<double> u{};

    void reset(const Vec2& first) {
        u.clear();
        for (const CurvePointer& curve : curves) {  // from the nearest of 200 samples
            Nearest nearest{.hip = first};
            const double lo = curve->et[curve->ik - 1];
            const double hi = curve->et[curve->in];
            u.push_back(lo);
            for (int i = 0; i <= 200; ++i) {
                const double at = lo + (hi - lo) * i / 200.0;
                if (nearest.offer(curve.get(), at)) {
                    u.back() = at;
                }
            }
        }
    }
    Answer<2> answer(const Vec2& hip) {
        Nearest nearest{.hip = hip};
        for (std::size_t i = 0; i < curves.size(); ++i) {
            SISLCurve* const curve = curves[i].get();
            std::array<double, 2> point{hip.x, hip.y};
            double next = u[i];
            int status = 0;
            s1774(curve, point.data(), 2, resolution, curve->et[curve->ik - 1],
                  curve->et[curve->in], u[i], &next, &status);
            u[i] = status >= 0 ? next : u[i];
            nearest.offer(curve, u[i]);
        }
        return nearest.best;
    }
};

SurfacePointer sisl_surface(const Surface& data) {
    bool polynomial = true;
    for (const double w : data.weights) {
        polynomial = polynomial && w == data.weights.front();
    }
    std::vector<double> knots_u = data.knots_u;
    std::vector<double> knots_v = data.knots_v;
    std::vector<double> coefficients;
    for (std::size_t i = 0; i < data.points.size(); ++i) {
        const double w = polynomial ? 1.0 : data.weights[i];
        for (int k = 0; k < 3; ++k) {
            coefficients.push_back(w * data.points[i][k]);
        }
        if (!polynomial) {
            coefficients.push_back(w);
        }
    }
    const SurfacePointer surface(
        newSurf(static_cast<int>(data.columns), static_cast<int>(data.rows), kSurfaceDegree + 1,
                kSurfaceDegree + 1, knots_u.data(), knots_v.data(), coefficients.data(),
                polynomial ? kPolynomial : kRational, 3, kCopied),
        freeSurf);
    if (surface == nullptr) {
        throw std::runtime_error("SISL takes no such surface");
    }
    return surface;
}

Answer<3> surface_answer(SISLSurf* surface, std::array<double, 2> uv, const Vec3& hip) {
    std::array<double, 3> point{};
    std::array<double, 3> normal{};
    int left_u = 0;
    int left_v = 0;
    int status = 0;
    s1421(surface, 0, uv.data(), &left_u, &left_v, point.data(), normal.data(), &status);
    const Vec3 foot{point[0], point[1], point[2]};
    return {foot, glm::length(foot - hip)};
}

struct OneClosestOnSurface {
    SurfacePointer surface;
    double resolution = kResolution;

    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& hip) const {
        std::array<double, 3> point{hip.x, hip.y, hip.z};
        std::array<double, 2> uv{};
        double distance = 0.0;
        int status = 0;
        s1958(surface.get(), point.data(), 3, kComputing, resolution, uv.data(), &distance,
              &status);
        return surface_answer(surface.get(), uv, hip);
    }
};

struct AllClosestOnSurface {
    SurfacePointer surface;
    double resolution = kResolution;

    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& hip) const {
        std::array<double, 3> point{hip.x, hip.y, hip.z};
        int count = 0;
        int arcs = 0;
        int status = 0;
        double* uv = nullptr;
        SISLIntcurve** arc = nullptr;
        s1954(surface.get(), point.data(), 3, kComputing, resolution, &count, &uv, &arcs, &arc,
              &status);
        Answer<3> best{{}, std::numeric_limits<double>::infinity()};
        for (int i = 0; status >= 0 && i < count; ++i) {
            const auto found = surface_answer(surface.get(), {uv[2 * i], uv[2 * i + 1]}, hip);
            best = found.distance < best.distance ? found : best;
        }
        for (int i = 0; status >= 0 && i < arcs; ++i) {
            const double* const on = arc[i]->epar1;
            const auto found = surface_answer(surface.get(), {on[0], on[1]}, hip);
            best = found.distance < best.distance ? found : best;
        }
        std::free(uv);
        if (arc != nullptr) {
            freeIntcrvlist(arc, arcs);
        }
        return best;
    }
};

struct WarmLocalOnSurface {
    SurfacePointer surface;
    double resolution = kResolution;
    std::array<double, 2> uv{};

    void reset(const Vec3& first) {
        double distance = 0.0;
        int status = 0;
        std::array<double, 3> point{first.x, first.y, first.z};
        s1958(surface.get(), point.data(), 3, kComputing, resolution, uv.data(), &distance,
              &status);
    }
    Answer<3> answer(const Vec3& hip) {
        std::array<double, 3> point{hip.x, hip.y, hip.z};
        std::array<double, 2> low{surface->et1[surface->ik1 - 1], surface->et2[surface->ik2 - 1]};
        std::array<double, 2> high{surface->et1[surface->in1], surface->et2[surface->in2]};
        std::array<double, 2> next = uv;
        int status = 0;
        s1775(surface.get(), point.data(), 3, resolution, low.data(), high.data(), uv.data(),
              next.data(), &status);
        uv = status >= 0 ? next : uv;
        return surface_answer(surface.get(), uv, hip);
    }
};

}  // namespace

Methods<2> sisl_methods(const Object& object) {
    std::vector<CurvePointer> curves;
    std::vector<Vec2> points;
    for (const auto& data : object.curves) {
        curves.push_back(sisl_curve(data));
        points.insert(points.end(), data.points.begin(), data.points.end());
    }
    const double resolution = resolution_of<2>(points);
    Methods<2> methods;
    methods.push_back(
        make_method<2>("SISL s1957 (one closest)", Kind::peer, OneClosest{curves, resolution}));
    methods.push_back(
        make_method<2>("SISL s1774 (warm, local)", Kind::peer, WarmLocal{curves, resolution}));
    methods.push_back(
        make_method<2>("SISL s1953 (all closest)", Kind::peer, AllClosest{curves, resolution}));
    return methods;
}

Methods<3> sisl_surface_methods(const Surface& data) {
    const SurfacePointer surface = sisl_surface(data);
    const double resolution = resolution_of<3>(data.points);
    Methods<3> methods;
    methods.push_back(make_method<3>("SISL s1958 (one closest)", Kind::peer,
                                     OneClosestOnSurface{surface, resolution}));
    methods.push_back(make_method<3>("SISL s1775 (warm, local)", Kind::peer,
                                     WarmLocalOnSurface{surface, resolution}));
    methods.push_back(make_method<3>("SISL s1954 (all closest)", Kind::peer,
                                     AllClosestOnSurface{surface, resolution}));
    return methods;
}

}  // namespace palpate::bench
