#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/outline.hpp"
#include "engine/rendering/scene.hpp"
#include "engine/surface/nurbs_surface.hpp"
#include "protocols/file/schema.hpp"

/// Scene files of the offline tools (`palpate render`, `palpate closest`): TOML text -> curves or a
/// surface, and how they are to be felt. Problems are reported like those of a protocol.
namespace palpate::protocols {

/// The laws by which the contact force can be computed beside those of a protocol: the thesis'
/// Algorithm 1.
inline constexpr std::array<std::string_view, 2> kThesisLaws{"thesis_literal", "thesis_latched"};

/// Whether the contact force follows one of the thesis' laws.
[[nodiscard]] constexpr bool is_thesis_law(std::string_view law) noexcept {
    return law.starts_with("thesis_");
}

/// How the closest point is found: proved the nearest, or followed in one of the thesis' ways.
enum class Tracker : std::uint8_t {
    certified,
    feedback,
    feed_forward,
    feedback_linearised,
    tangent_plane,
    newton,
};

template <>
inline constexpr std::array<std::string_view, 6> kWordsOf<Tracker>{
    "certified", "feedback", "feed_forward", "feedback_linearised", "tangent_plane", "newton"};

/// The largest coordinate, m: the squares of distances to farther places would overflow or round
/// away.
inline constexpr double kFarthest = 1e6;

/// How the contact of a scene is computed.
struct SceneRenderer {
    double stiffness = 1000.0;  ///< N/m
    double damping = 0.0;       ///< N s/m, of the virtual coupling
    double compliance = 0.0;    ///< m/N, of two curves on a base line; 0: rigid
    Tracker tracker = Tracker::certified;
    double gain = 1e5;       ///< feedback, feed_forward: 1/(m^2 s); feedback_linearised: 1/s
    int sub_steps = 1;       ///< of these three: explicit Euler steps a tick
    double rate_hz = 100.0;  ///< tangent_plane: refreshes a second
    int iterations = 1;      ///< newton: steps a tick

    /// The scene is the one of experiments; the other trackers are the thesis', for comparison.
    [[nodiscard]] bool certified() const noexcept { return tracker == Tracker::certified; }
};

/// How friction is computed.
struct SceneFriction {
    std::string law = "frictionless";  ///< as [[friction]] of a protocol, or of kThesisLaws
    engine::Friction set{};
    engine::Slew slew{};
    engine::LawSpec own{};   ///< of a law of engine/friction/laws
    double dead_band = 0.0;  ///< m/s: the thesis' laws take slower CPs for resting
};

/// Everything that a scene file says. Either plane curves, curves in space, or surfaces.
struct SceneFile {
    SceneRenderer renderer{};
    SceneFriction friction{};
    std::vector<engine::NurbsCurve<2>> curves;
    std::vector<engine::NurbsCurve<3>> space_curves;
    /// The pieces that trims leave, and of each its [[surface]], counted from 0.
    std::vector<std::shared_ptr<const engine::NurbsSurface>> surfaces;
    std::vector<std::size_t> surface_of;
    Places places{};  ///< where everything stands

    /// Whether the thesis' renderer is asked for: by its law, or by its tracker where the tracker
    /// decides the force. With friction our law needs no tracker in contact; the column cp alone
    /// would differ.
    [[nodiscard]] bool by_thesis() const noexcept {
        return is_thesis_law(friction.law) ||
               (!renderer.certified() && friction.law == "frictionless");
    }

    /// 2 or 3: the number of coordinates of its points.
    [[nodiscard]] int dimension() const noexcept { return curves.empty() ? 3 : 2; }
};

/// Whether a closed outline may cross itself. The engine renders it, by the side of the nearest
/// curve, and tests of the engine try it; inside and outside are then nobody's.
enum class Crossings : std::uint8_t { refused, taken };

/// @throws ProtocolError with one line a problem: file:line:column, what, the value, what to do
[[nodiscard]] SceneFile parse_scene(std::string_view text,
                                    std::string_view file_name,
                                    Crossings crossings = Crossings::refused);

/// parse_scene of a file's text. @throws ProtocolError also if the file cannot be read
[[nodiscard]] SceneFile load_scene(const std::filesystem::path& file);

/// What a scene file may say.
[[nodiscard]] std::vector<TableText> scene_reference();

/// The chain of a scene's plane curves: closed if the last ends where the first starts.
/// @throws std::invalid_argument if consecutive curves share no end point
[[nodiscard]] engine::Outline outline_of(const SceneFile& scene);

/// That the engine refuses to feel a scene, at the segment of which its sentence speaks.
/// @param name  of the scene's file
[[nodiscard]] ProtocolError not_felt(const SceneFile& scene,
                                     std::string_view name,
                                     std::string_view why);

/// What the engine needs of a scene whose law is none of the thesis'.
/// @param period  tick period, s
[[nodiscard]] engine::SceneSpec spec_of(const SceneFile& scene, double period) noexcept;

}  // namespace palpate::protocols
