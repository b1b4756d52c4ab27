#pragma once

#include "engine/geometry/outline.hpp"
#include "protocols/file/scene_file.hpp"
#include "tests/support/nurbs_oracle.hpp"
#include "tests/support/random.hpp"

/// Random things to feel: whatever a scene file may say about plane curves, often at its worst.
namespace palpate::stress {

struct StressScene {
    std::uint64_t seed = 0;
    std::vector<tests::NurbsData<2>> segments;  ///< joined end to end; the last may meet the first
    protocols::SceneRenderer renderer{};
    protocols::SceneFriction friction{};
    double period = 0.001;  ///< s
};

/// How wild scenes and hands are.
enum class Mood : std::uint8_t {
    /// What experiments feel: arcs, edges, smooth blobs, and a hand that jumps only in the air.
    gentle,
    wild,   ///< whatever is not refused
    study,  ///< two arcs over a base line, as the study has them, and a gentle hand
    cusp,   ///< cusps, kinks, repeated points, heavy weights; a hand at centres of curvature
    huge,   ///< gentle scenes, and a hand that is elsewhere on every tick
};

/// What every mood is called.
inline constexpr std::array<const char*, 5> kMoods{"gentle", "wild", "study", "cusp", "huge"};

/// One seed is one scene. Wild: NURBS chains of degree 1 to 9, weights 1e-3 to 1e3, sizes 1e-6 to
/// 1e3 m, with kinks, cusps, spikes and vertices of any angle; any law, stiffness, damper and slew.
[[nodiscard]] StressScene random_scene(std::uint64_t seed, Mood mood);

/// What a scene may be rubbed by, and numbers of one of them.
inline constexpr std::array<const char*, 3> kLaws{"frictionless", "gos", "coulomb"};
[[nodiscard]] engine::Friction random_friction(tests::Random& random, std::string_view law);

/// As `palpate render` reads them, every number with all its digits: a scene, what a law of kLaws
/// has of a friction, and a path, of which what is not finite is left out.
[[nodiscard]] std::string scene_text(const StressScene& scene);
[[nodiscard]] std::string friction_text(std::string_view law, const engine::Friction& friction);
template <class Point>
[[nodiscard]] std::string path_text(const std::vector<Point>& path, double period) {
    std::string text = Point::length() == 2 ? "t_s,x_m,y_m\n" : "t_s,x_m,y_m,z_m\n";
    for (std::size_t i = 0; i < path.size(); ++i) {
        std::string line = fmt::format("{}", static_cast<double>(i) * period);
        bool finite = true;
        for (int k = 0; k < Point::length(); ++k) {
            line += fmt::format(",{}", path[i][k]);
            finite = finite && std::isfinite(path[i][k]);
        }
        text += finite ? line + '\n' : "";
    }
    return text;
}

/// Turns a closed scene about so that it runs clockwise, as Outline asks.
void reverse(StressScene& scene);

[[nodiscard]] protocols::SceneFile scene_file_of(const StressScene& scene);

struct HandSpec {
    std::size_t ticks = 400;
    double period = 0.001;  ///< s
    bool broken = true;     ///< NaN and infinities may occur
    bool far = false;       ///< so may HIPs up to 1e150 m away
    bool leaps = false;     ///< anywhere on every tick, inside more often than not
    bool gentle = false;    ///< a hundredth of the object a tick at most; lifts off before it jumps
};

[[nodiscard]] std::vector<engine::Vec2> random_path(tests::Random& random,
                                                    const engine::Outline& outline,
                                                    const HandSpec& spec);

/// Diagonal of the outline's control points, m.
[[nodiscard]] double size_of(const engine::Outline& outline);

}  // namespace palpate::stress
