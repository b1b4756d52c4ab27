#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/device/homing.hpp"
#include "engine/device/machine.hpp"

/// Do the encoders say where the handle is? A person brings it to places that are known; no motor
/// turns meanwhile.
namespace palpate::engine {

/// How two encoders, or two motors, may be connected otherwise than the calibration says.
struct Connection {
    bool swapped = false;
    std::array<double, 2> factor{1.0, 1.0};  ///< of joint 1 and 2: < 0 reversed; 0.5, 2 the gain

    friend bool operator==(const Connection&, const Connection&) = default;
};

/// As people say it: "encoder 1 is reversed and encoder 2 counts twice"; empty: nothing is wrong.
/// @param one, much, little  "encoder", "counts too much", "counts too little"
[[nodiscard]] std::string explained(const Connection& connection,
                                    const std::string& one,
                                    const std::string& much,
                                    const std::string& little);

/// Every connection of two: either order, signs, and factors 1/2, 1, 2; the right one first.
[[nodiscard]] std::vector<Connection> all_connections();

/// Which connection makes the counts fit the places.
struct EncoderProof {
    Connection connection{};  ///< that fits best; the right one whenever it fits
    bool fits = false;        ///< every mark is met to within kPlaced
    double missed = 0.0;      ///< m, the worst mark with the connection that was found
};

/// How exactly a person brings a handle to a mark, m.
inline constexpr double kPlaced = 0.005;
/// m by which encoders may say that it is beside it, between trials.
inline constexpr double kAtPlace = 0.002;

/// @param marks  the first one is home, whose counts are those of the calibration
/// @throws std::invalid_argument for fewer than two
[[nodiscard]] EncoderProof prove_encoders(const PantographSpec& spec,
                                          std::span<const MarkReading> marks);

/// By how far the wrong connection that is hardest to see misses one of `places`, m: it has to be
/// more than 2 kPlaced. Home is the first of them.
/// @param plugs  of those alone that are exchanged or reversed; how much they count pulses tell
[[nodiscard]] double separation(const PantographSpec& spec,
                                std::span<const Vec2> places,
                                bool plugs = false);

/// Home, and two places within the study's 80 x 60 mm that tell all connections best.
/// @throws std::invalid_argument if no two tell them
[[nodiscard]] std::vector<Vec2> commissioning_places(const PantographSpec& spec, const Vec2& home);

/// Where the handle is brought at each opening, besides home: of the places of a commissioning the
/// one that exchanged or reversed plugs miss by most, for where a motor goes with its encoder
/// pulses may not tell; else another place within reach. Of straight axes, each of which was proved
/// alone, a place as far along each as another one's plug would not say.
/// @param places  home first   @return m
/// @throws std::invalid_argument if none is missed by what a person and a look may miss it
[[nodiscard]] Vec3 second_mark(const Calibration& machine, const std::vector<Vec3>& places);

}  // namespace palpate::engine
