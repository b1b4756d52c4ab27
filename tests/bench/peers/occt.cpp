// Open CASCADE Technology 7.6 (Debian's libocct-modeling-algorithms-dev).

#include <Extrema_ExtPC2d.hxx>
#include <Extrema_ExtPS.hxx>
#include <Extrema_GenLocateExtPS.hxx>
#include <Extrema_LocateExtPC2d.hxx>
#include <Extrema_POnCurv2d.hxx>
#include <Extrema_POnSurf.hxx>
#include <Geom2dAPI_ProjectPointOnCurve.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_Array2OfPnt.hxx>

#include "tests/bench/peers/peers.hpp"

namespace palpate::bench {
namespace {

constexpr double kTolerance = 1e-12;

/// Knots without repetitions, and how often each came.
struct Multiple {
    std::vector<double> knots;
    std::vector<int> times;

    explicit Multiple(const std::vector<double>& all) {
        for (const double knot : all) {
            if (knots.empty() || knots.back() != knot) {
                knots.push_back(knot);
                times.push_back(0);
            }
            ++times.back();
        }
    }
    [[nodiscard]] TColStd_Array1OfReal values() const {
        TColStd_Array1OfReal array(1, static_cast<int>(knots.size()));
        for (std::size_t i = 0; i < knots.size(); ++i) {
            array.SetValue(static_cast<int>(i) + 1, knots[i]);
        }
        return array;
    }
    [[nodiscard]] TColStd_Array1OfInteger multiplicities() const {
        TColStd_Array1OfInteger array(1, static_cast<int>(times.size()));
        for (std::size_t i = 0; i < times.size(); ++i) {
            array.SetValue(static_cast<int>(i) + 1, times[i]);
        }
        return array;
    }
};

struct Curve {
    Handle(Geom2d_BSplineCurve) curve;
    Geom2dAdaptor_Curve adaptor;
    std::vector<gp_Pnt2d> corners{};  ///< ends and kinks: OCCT finds normals only

    explicit Curve(const tests::NurbsData<2>& data) {
        const int count = static_cast<int>(data.points.size());
        TColgp_Array1OfPnt2d poles(1, count);
        TColStd_Array1OfReal weights(1, count);
        for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            poles.SetValue(i + 1, gp_Pnt2d(data.points[at].x, data.points[at].y));
            weights.SetValue(i + 1, data.weights[at]);
        }
        const Multiple knots(data.knots);
        curve = new Geom2d_BSplineCurve(poles, weights, knots.values(), knots.multiplicities(),
                                        data.degree);
        adaptor.Load(curve);
        for (std::size_t i = 0; i < knots.knots.size(); ++i) {
            if (knots.times[i] >= data.degree) {
                corners.push_back(curve->Value(knots.knots[i]));
            }
        }
    }
    [[nodiscard]] double lo() const { return curve->FirstParameter(); }
    [[nodiscard]] double hi() const { return curve->LastParameter(); }
};

using Curves = std::vector<std::shared_ptr<const Curve>>;

struct Nearest {
    gp_Pnt2d hip;
    gp_Pnt2d foot{};
    double distance2 = std::numeric_limits<double>::infinity();

    void offer(const gp_Pnt2d& point, double square) {
        if (square < distance2) {
            distance2 = square;
            foot = point;
        }
    }
    void offer(const gp_Pnt2d& point) { offer(point, point.SquareDistance(hip)); }
    void offer_corners(const Curve& curve) {
        for (const gp_Pnt2d& corner : curve.corners) {
            offer(corner);
        }
    }
    [[nodiscard]] Answer<2> answer() const { return {{foot.X(), foot.Y()}, foot.Distance(hip)}; }
};

struct Project {
    Curves curves;

    void reset(const Vec2& /*first*/) {}
    Answer<2> answer(const Vec2& hip) const {
        Nearest nearest{gp_Pnt2d(hip.x, hip.y)};
        for (const auto& curve : curves) {
            const Geom2dAPI_ProjectPointOnCurve found(nearest.hip, curve->curve);
            if (found.NbPoints() > 0) {
                nearest.offer(found.NearestPoint());
            }
            nearest.offer_corners(*curve);
        }
        return nearest.answer();
    }
};

/// The same solver, prepared once a curve.
struct Extrema {
    Curves curves;
    std::vector<std::unique_ptr<Extrema_ExtPC2d>> solvers{};

    explicit Extrema(Curves all) : curves(std::move(all)) {
        for (const auto& curve : curves) {
            solvers.push_back(std::make_unique<Extrema_ExtPC2d>());
            solvers.back()->Initialize(curve->adaptor, curve->lo(), curve->hi(), kTolerance);
        }
    }
    void reset(const Vec2& /*first*/) {}
    Answer<2> answer(const Vec2& hip) const {
        Nearest nearest{gp_Pnt2d(hip.x, hip.y)};
        for (std::size_t i = 0; i < curves.size(); ++i) {
            solvers[i]->Perform(nearest.hip);
            if (solvers[i]->IsDone()) {
                for (int k = 1; k <= solvers[i]->NbExt(); ++k) {
                    nearest.offer(solvers[i]->Point(k).Value(), solvers[i]->SquareDistance(k));
                }
            }
            nearest.offer_corners(*curves[i]);
        }
        return nearest.answer();
    }
};

/// From the parameter of the tick before, on each curve.
struct Locate {
    Curves curves;
    std::vector<std::unique_ptr<Extrema_LocateExtPC2d>> solvers{};
    std::vector<double> u{};

    explicit Locate(Curves all) : curves(std::move(all)) {
        for (const auto& curve : curves) {
            solvers.push_back(std::make_unique<Extrema_LocateExtPC2d>());
            solvers.back()->Initialize(curve->adaptor, curve->lo(), curve->hi(), kTolerance);
        }
    }
    void reset(const Vec2& first) {
        u.clear();
        const gp_Pnt2d hip(first.x, first.y);
        for (const auto& curve : curves) {
            u.push_back(curve->lo());
            for (int i = 1; i <= 200; ++i) {
                const double at = curve->lo() + (curve->hi() - curve->lo()) * i / 200.0;
                if (curve->curve->Value(at).SquareDistance(hip) <
                    curve->curve->Value(u.back()).SquareDistance(hip)) {
                    u.back() = at;
                }
            }
        }
    }
    Answer<2> answer(const Vec2& hip) {
        Nearest nearest{gp_Pnt2d(hip.x, hip.y)};
        for (std::size_t i = 0; i < curves.size(); ++i) {
            solvers[i]->Perform(nearest.hip, u[i]);
            if (solvers[i]->IsDone()) {
                u[i] = solvers[i]->Point().Parameter();
                nearest.offer(solvers[i]->Point().Value(), solvers[i]->SquareDistance());
            } else {
                nearest.offer(curves[i]->curve->Value(u[i]));
            }
            nearest.offer_corners(*curves[i]);
        }
        return nearest.answer();
    }
};

Handle(Geom_BSplineSurface) occt_surface(const Surface& data) {
    const int columns = static_cast<int>(data.columns);
    const int rows = static_cast<int>(data.rows);
    TColgp_Array2OfPnt poles(1, columns, 1, rows);
    TColStd_Array2OfReal weights(1, columns, 1, rows);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto at = static_cast<std::size_t>(j * columns + i);
            const Vec3& p = data.points[at];
            poles.SetValue(i + 1, j + 1, gp_Pnt(p.x, p.y, p.z));
            weights.SetValue(i + 1, j + 1, data.weights[at]);
        }
    }
    const Multiple u(data.knots_u);
    const Multiple v(data.knots_v);
    return new Geom_BSplineSurface(poles, weights, u.values(), v.values(), u.multiplicities(),
                                   v.multiplicities(), kSurfaceDegree, kSurfaceDegree);
}

Answer<3> answer_at(const gp_Pnt& foot, const gp_Pnt& hip) {
    return {{foot.X(), foot.Y(), foot.Z()}, foot.Distance(hip)};
}

struct ProjectOnSurface {
    Handle(Geom_BSplineSurface) surface;

    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& hip) const {
        const gp_Pnt point(hip.x, hip.y, hip.z);
        const GeomAPI_ProjectPointOnSurf found(point, surface);
        return found.NbPoints() > 0 ? answer_at(found.NearestPoint(), point) : Answer<3>{};
    }
};

struct ExtremaOnSurface {
    std::shared_ptr<const GeomAdaptor_Surface> adaptor;
    std::shared_ptr<Extrema_ExtPS> solver = std::make_shared<Extrema_ExtPS>();

    explicit ExtremaOnSurface(const Handle(Geom_BSplineSurface) & surface)
        : adaptor(std::make_shared<const GeomAdaptor_Surface>(surface)) {
        solver->Initialize(*adaptor, adaptor->FirstUParameter(), adaptor->LastUParameter(),
                           adaptor->FirstVParameter(), adaptor->LastVParameter(), kTolerance,
                           kTolerance);
    }
    void reset(const Vec3& /*first*/) {}
    Answer<3> answer(const Vec3& hip) const {
        const gp_Pnt point(hip.x, hip.y, hip.z);
        solver->Perform(point);
        Answer<3> best{{}, std::numeric_limits<double>::infinity()};
        for (int k = 1; solver->IsDone() && k <= solver->NbExt(); ++k) {
            const Answer<3> found = answer_at(solver->Point(k).Value(), point);
            best = found.distance < best.distance ? found : best;
        }
        return best;
    }
};

struct LocateOnSurface {
    Handle(Geom_BSplineSurface) surface;
    std::shared_ptr<const GeomAdaptor_Surface> adaptor;
    std::shared_ptr<Extrema_GenLocateExtPS> solver;
    double u = 0.0;
    double v = 0.0;

    explicit LocateOnSurface(Handle(Geom_BSplineSurface) own)
        : surface(std::move(own)),
          adaptor(std::make_shared<const GeomAdaptor_Surface>(surface)),
          solver(std::make_shared<Extrema_GenLocateExtPS>(*adaptor, kTolerance, kTolerance)) {}
    void reset(const Vec3& first) {
        const GeomAPI_ProjectPointOnSurf found(gp_Pnt(first.x, first.y, first.z), surface);
        found.LowerDistanceParameters(u, v);
    }
    Answer<3> answer(const Vec3& hip) {
        const gp_Pnt point(hip.x, hip.y, hip.z);
        solver->Perform(point, u, v);
        if (solver->IsDone()) {
            solver->Point().Parameter(u, v);
            return answer_at(solver->Point().Value(), point);
        }
        return answer_at(adaptor->Value(u, v), point);
    }
};

}  // namespace

Methods<2> occt_methods(const Object& object) {
    Curves curves;
    for (const auto& data : object.curves) {
        curves.push_back(std::make_shared<const Curve>(data));
    }
    Methods<2> methods;
    methods.push_back(make_method<2>("OCCT Geom2dAPI_ProjectPoint", Kind::peer, Project{curves}));
    methods.push_back(make_method<2>("OCCT Extrema_ExtPC2d, reused", Kind::peer, Extrema(curves)));
    methods.push_back(
        make_method<2>("OCCT LocateExtPC2d (warm, local)", Kind::peer, Locate(curves)));
    return methods;
}

Methods<3> occt_surface_methods(const Surface& data) {
    const Handle(Geom_BSplineSurface) surface = occt_surface(data);
    Methods<3> methods;
    methods.push_back(
        make_method<3>("OCCT GeomAPI_ProjectPointOnSurf", Kind::peer, ProjectOnSurface{surface}));
    methods.push_back(
        make_method<3>("OCCT Extrema_ExtPS, reused", Kind::peer, ExtremaOnSurface(surface)));
    methods.push_back(
        make_method<3>("OCCT GenLocateExtPS (warm, local)", Kind::peer, LocateOnSurface(surface)));
    return methods;
}

}  // namespace palpate::bench
