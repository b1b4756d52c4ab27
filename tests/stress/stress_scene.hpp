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

/// As `palpate render` reads it, every number with all its digits.
[[nodiscard]] std::string scene_text(const StressScene& scene);

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
