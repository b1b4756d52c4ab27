#pragma once

#include "engine/surface/flow_spot.hpp"

namespace palpate::engine {

/// Follows the flow of a sliding god-object inside one patch (FlowSpot has its equations) to the
/// first place within the cone, or to the edge of the patch.
///
/// Since the second derivative along the flow is known, y'' = g(y) with y' = f(y0) at the start of
/// each step: Nystroem's method of order 5 with three evaluations (Hairer, Norsett & Wanner,
/// Solving Ordinary Differential Equations I, II.14), its error measured by how far the direction
/// at its end is from the sum of the bends on the way; a short step by one evaluation and the
/// corrector y0 + h/2 (f0 + f1) + h^2/12 (g0 - g1) of order 4. The error of a step is below
/// kFlowError (without friction kBudgetError) of the stretch, or of the object's size if that is
/// less: however far a hand is, its way lies on the surface. Where the excess over the cone changes
/// sign along a step, at its ends, its stages or between them, the first such place is closed in on
/// the quintic through the step.
class SurfaceFlow {
public:
    struct Arrival {
        enum class End : std::uint8_t {
            cone,    ///< on the inner side of the cone's edge
            edge,    ///< on an edge of the patch, outside of the cone
            spent,   ///< `max` is used up
            foot,    ///< close to a foot that carries nothing
            failed,  ///< the flow has no direction here, or the work limit is reached
        };
        SurfaceSpot spot;
        double way = 0.0;  ///< m
        End end = End::failed;
    };

    /// One flow. @param limit  of ground.work()
    SurfaceFlow(SurfaceGround& ground, Work limit) noexcept : ground_(ground), limit_(limit) {}

    /// @param from  outside of its cone, whose drive leads into its patch
    /// @param max  way that may be used, m
    [[nodiscard]] Arrival follow(const SurfaceSpot& from, double max) noexcept;

private:
    struct Node {
        double x;
        double excess;
        double rate;  ///< per step
    };
    struct Step {
        double h;
        double error;
        FlowSpot to;
        Vec2 end;
        double excess;  ///< at the end
        Node nodes[4];
        int count = 0;
    };
    /// Over an edge of the patch.
    struct Exit {
        double x = 2.0;  ///< share of the step; 2: it stays within
        double border = 0.0;
        bool in_u = true;
    };
    [[nodiscard]] Arrival walk() noexcept;
    void look(const Vec2& at, FlowSpot& spot) noexcept;
    void end_at(const Vec2& at, double way, Arrival::End end, Arrival& to) noexcept;
    [[nodiscard]] bool near_foot() const noexcept;
    [[nodiscard]] double wanted() const noexcept;
    [[nodiscard]] bool take(double h, Step& step) noexcept;
    [[nodiscard]] double longest_after(const Step& step) const noexcept;
    [[nodiscard]] bool short_step(const FlowSpot& from, double h, Step& step) noexcept;
    [[nodiscard]] bool long_step(const FlowSpot& from, double h, Step& step) noexcept;
    [[nodiscard]] Exit exit_of(const FlowArc& arc, const Step& step) const noexcept;
    [[nodiscard]] bool meets_cone(
        const FlowArc& arc, const Step& step, double out, SurfaceSpot& spot, double& x) noexcept;
    [[nodiscard]] bool into_cone(
        const FlowArc& arc, Node low, Node high, SurfaceSpot& spot, double& x) noexcept;
    [[nodiscard]] bool tired() const noexcept { return ground_.work() >= limit_; }

    SurfaceGround& ground_;
    Work limit_;
    SurfacePlace place_{};
    FlowSpot at_;             ///< so far
    double way_ = 0.0;        ///< m
    double max_ = 0.0;        ///< m
    double longest_ = 1e300;  ///< next step, m
    double tolerance_ = 0.0;  ///< of a step, m
    double least_ = 0.0;      ///< step, m
    double noise_ = 0.0;      ///< of the start, m
    double rounding_ = 0.0;   ///< of the start, m
};

}  // namespace palpate::engine
