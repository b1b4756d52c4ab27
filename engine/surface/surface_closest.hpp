#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/surface/surface_foot.hpp"
#include "engine/surface/surface_leaf.hpp"
#include "engine/surface/surface_object.hpp"

namespace palpate::engine {

/// The closest point of a surface.
struct SurfaceClosest {
    double u = 0.0;
    double v = 0.0;
    SurfacePlace place{};
    Vec3 point{};           ///< m, world frame
    double distance = 0.0;  ///< |h - point|, m
    bool inside = false;    ///< h lies behind the outward normal, and not beyond an open border
    bool proven = true;     ///< false: the work limit ended the search; the best foot found
};

/// What a tracker keeps from tick to tick. A plain value; a fresh one knows nothing.
///
/// The certificate: at `reference` it was proved that |S - h|^2 has one minimum in `window`, and
/// that it still has while h moves by `slack`; at `searched`, that everything outside of the window
/// was `other` away.
struct SurfaceTrack {
    struct Window {  ///< leaves [low, high) of the grid over all patches of one surface
        std::uint32_t surface = 0;
        std::uint32_t low_u = 0;
        std::uint32_t high_u = 0;
        std::uint32_t low_v = 0;
        std::uint32_t high_v = 0;
    };

    bool started = false;
    bool certified = false;
    SurfacePlace place{};   ///< of the jet, within 1e-7 of a patch of the last answer
    SurfaceJet jet{};       ///< there, as SurfaceFoot keeps it
    Vec3 reference{};       ///< relative to the surface's origin, m
    double distance = 0.0;  ///< at reference, m
    double slack = 0.0;     ///< m
    Vec3 searched{};        ///< relative to the surface's origin, m
    double other = 0.0;     ///< m
    Window window{};
    std::uint64_t searches = 0;         ///< calls that had to search the whole surface
    std::uint64_t certified_calls = 0;  ///< calls answered by the certificate alone
};

/// The closest point of a whole object, borders and corners included, with a proof.
///
/// Every patch is divided into leaves at construction, each with an oriented box and bounds on the
/// second derivatives of |S - h|^2 that are linear in h; a tree of boxes stands above them. A
/// search goes downhill to a foot, collects the leaves round it in which the distance is a proven
/// bowl, and shows for all others that they are farther: by their boxes, or by Bernstein
/// coefficients (DistanceForm). What is closer starts it anew from there.
///
/// `distance` is the global minimum to rounding, 1e-15 of the object's size plus the distance, also
/// for weights of 1e-3 to 1e3. With ties any of the feet. The proof fails, and says so, where a
/// patch is degenerate to a line under different weights, and in bent valleys that weights of 1e-3
/// to 1e3 make. A HIP that is not finite has the distance infinity and is not proven. A search
/// needs 300 kB of stack.
class SurfaceFeet {
public:
    /// @throws std::invalid_argument for no object
    explicit SurfaceFeet(std::shared_ptr<const SurfaceObject> object);
    /// Of one surface. @throws std::invalid_argument for a null surface
    explicit SurfaceFeet(std::shared_ptr<const NurbsSurface> surface)
        : SurfaceFeet(std::make_shared<const SurfaceObject>(
              std::vector<std::shared_ptr<const NurbsSurface>>{std::move(surface)})) {}

    /// What a search may cost that nobody waits for: a second. Only patches that are a line or a
    /// point, with different weights, are known to need it.
    static constexpr Work kPatience = 3'000'000'000;

    /// Global, from nothing. @param hip  m, world frame, finite
    [[nodiscard]] SurfaceClosest closest(const Vec3& hip) const noexcept;

    /// Global, starting from the last tick's answer: no search while the certificate holds.
    /// @param work  what a search may cost; beyond it the best foot found, not proven
    [[nodiscard]] SurfaceClosest track(SurfaceTrack& track,
                                       const Vec3& hip,
                                       Work work = kPatience) const noexcept;

    /// The last answer is also the local foot of `place`: both lie in the same proven bowl.
    [[nodiscard]] bool same_bowl(const SurfaceTrack& track,
                                 const SurfacePlace& place) const noexcept {
        return track.certified && in_window(track.window, place);
    }

    /// Whose closest points it finds; and into how many leaves its patches were cut.
    [[nodiscard]] const SurfaceObject& object() const noexcept { return *object_; }
    [[nodiscard]] std::size_t leaves() const noexcept { return leaves_.size(); }

private:
    using Window = SurfaceTrack::Window;
    struct Node {
        Box<3> box{};
        std::uint32_t low = 0;   ///< child, or the leaf if `high` is 0
        std::uint32_t high = 0;  ///< other child
    };

    /// The leaves of one surface: (a, b) at first + a across_v + b.
    struct Grid {
        std::uint32_t first = 0;
        std::uint32_t per_side = 1;  ///< leaves of a patch in each direction
        std::uint32_t across_u = 0;  ///< leaves of the whole surface along u
        std::uint32_t across_v = 0;
    };
    /// A leaf in its grid.
    struct Cell {
        std::uint32_t surface = 0;
        std::uint32_t a = 0;
        std::uint32_t b = 0;
    };

    /// An edge of a patch that is one point.
    struct Pole {
        SurfacePlace place{};  ///< the middle of the edge
        bool across_u = true;  ///< u leads away from it
        Vec3 point{};          ///< m, relative to the object's origin
    };

    void divide(std::uint32_t surface, std::uint32_t per_side);
    void find_poles(std::uint32_t surface);
    [[nodiscard]] double resolved(const Grid& grid) const noexcept;
    std::uint32_t build(const Window& part);
    std::uint32_t build(std::uint32_t first, std::uint32_t last);
    std::uint32_t above(std::uint32_t low, std::uint32_t high, std::uint32_t index);
    /// Patch of a leaf with the part of it, and the middle of that.
    [[nodiscard]] SurfacePlace middle_of(std::uint32_t leaf, PatchPart& part) const noexcept;

    /// A foot next to the place of a jet.
    struct FootPlace {
        SurfacePlace place{};
        Vec3 point{};
    };

    [[nodiscard]] bool follow(SurfaceTrack& track, const Vec3& h, FootPlace& moved) const noexcept;
    [[nodiscard]] bool renew(SurfaceTrack& track, const Vec3& h, double distance) const noexcept;
    [[nodiscard]] SurfaceClosest search(SurfaceTrack& track,
                                        const Vec3& h,
                                        Work work) const noexcept;
    void polish(SurfaceTrack& track, const Vec3& h, SurfaceFoot& foot, Work& work) const noexcept;
    [[nodiscard]] bool leave(const Pole& pole,
                             const Vec3& h,
                             SurfaceFoot& foot,
                             Work& work) const noexcept;
    [[nodiscard]] SurfacePlace near_place(const Vec3& h) const noexcept;
    [[nodiscard]] bool at_rest(const SurfaceTrack& track, const Vec3& h) const noexcept;
    void grow(SurfaceTrack& track, const Vec3& h, double d2) const noexcept;
    [[nodiscard]] double strip_slack(const Window& strip, const Vec3& h, double d2) const noexcept;
    [[nodiscard]] bool inside(const Window& window, std::uint32_t leaf) const noexcept;
    [[nodiscard]] bool in_window(const Window& window, const SurfacePlace& p) const noexcept;
    [[nodiscard]] Verdict look_around(SurfaceTrack& track,
                                      const Vec3& h,
                                      double d2,
                                      Work& work) const noexcept;
    [[nodiscard]] Verdict look_at(std::uint32_t leaf,
                                  const Vec3& h,
                                  double d2,
                                  Work& work) const noexcept;
    [[nodiscard]] SurfaceClosest answer(const SurfaceTrack& track,
                                        const Vec3& h,
                                        const FootPlace& moved) const noexcept;

    std::shared_ptr<const SurfaceObject> object_;
    std::vector<Grid> grids_;  ///< one a surface
    std::vector<Cell> cells_;  ///< one a leaf
    std::vector<SurfaceLeaf> leaves_;
    std::vector<Node> nodes_;
    std::vector<Pole> poles_;
};

}  // namespace palpate::engine
