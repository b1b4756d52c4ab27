#include "engine/commissioning/encoder_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/refuse.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::engine {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// Where the counts, taken by `connection`, put the handle; the right one takes them as they are.
std::optional<Vec2> place_of(const Pantograph& machine,
                             const JointAngles& home,
                             const Vec2& turned,
                             const Connection& connection) {
    JointAngles angles = home;
    for (int joint = 0; joint < 2; ++joint) {
        const int from = connection.swapped ? 1 - joint : joint;
        const auto at = static_cast<std::size_t>(joint);
        angles[at] += turned[from] / connection.factor[at] * machine.spec().axes[at].count_angle();
    }
    const auto fix = machine.locate(angles);
    return fix ? std::optional<Vec2>(fix->hip) : std::nullopt;
}

/// The worst distance of the marks from where `connection` puts the handle.
double missed_by(const Pantograph& machine,
                 std::span<const MarkReading> marks,
                 const Connection& connection) {
    const auto home = machine.reach(marks.front().place);
    double worst = home ? 0.0 : kNowhere;
    for (std::size_t i = 1; i < marks.size() && home; ++i) {
        const auto place =
            place_of(machine, *home, marks[i].counts - marks.front().counts, connection);
        worst = std::fmax(worst, place ? glm::length(*place - marks[i].place) : kNowhere);
    }
    return worst;
}

std::vector<MarkReading> exact_marks(const Pantograph& machine, std::span<const Vec2> places) {
    std::vector<MarkReading> marks;
    for (const Vec2& place : places) {
        const auto angles = machine.reach(place);
        if (!angles) {
            return {};
        }
        const auto counts = machine.counts(*angles);
        marks.push_back({.place = place,
                         .counts = {static_cast<double>(counts[0]), static_cast<double>(counts[1])},
                         .span = {}});
    }
    return marks;
}

/// Of a grid those within reach, far from home and from singular poses, m.
std::vector<Vec2> clear_places(const PantographSpec& spec, const Vec2& home) {
    constexpr double kStep = 0.010;
    constexpr double kClear = 0.008;  // m from singular poses: the force is a force there
    const Pantograph machine(spec);
    std::vector<Vec2> within;
    for (int i = -4; i <= 4; ++i) {
        for (int k = 0; k <= 6; ++k) {
            const Vec2 place{i * kStep, k * kStep};
            const auto angles = machine.reach(place);
            const auto fix = angles ? machine.locate(*angles) : std::nullopt;
            if (fix && fix->clearance >= kClear && glm::length(place - home) >= 2.0 * kStep) {
                within.push_back(place);
            }
        }
    }
    return within;
}

/// By how far encoders whose plugs are exchanged or reversed miss a place, m, at least.
/// @param quantum  of a count, m   @param way  of the place, from home, m
double missed_by_plugs(const Vec3& quantum, const Vec3& way) {
    double least = std::numeric_limits<double>::infinity();
    std::array<int, 3> plug{0, 1, 2};
    do {
        const bool in_order = std::ranges::is_sorted(plug);
        for (unsigned reversed = in_order ? 1 : 0; reversed < 8; ++reversed) {
            Vec3 said;
            for (int i = 0; i < 3; ++i) {
                const int from = plug[static_cast<std::size_t>(i)];
                const double sign = (reversed >> static_cast<unsigned>(i) & 1U) != 0 ? -1.0 : 1.0;
                said[i] = sign * way[from] * quantum[i] / quantum[from];
            }
            least = std::fmin(least, glm::length(said - way));
        }
    } while (std::ranges::next_permutation(plug).found);
    return least;
}

/// @param ways  from home along each axis, m
Vec3 straight_mark(const Gantry& gantry, const Vec3& ways, double& missed) {
    Vec3 best{};
    std::array<double, 3> shares{0.4, 0.7, 1.0};
    do {
        Vec3 way;
        for (int i = 0; i < 3; ++i) {
            way[i] = std::round(1e3 * ways[i] * shares[static_cast<std::size_t>(i)]) / 1e3;
        }
        if (const double least = missed_by_plugs(gantry.quantum(), way); least > missed) {
            missed = least;
            best = way;
        }
    } while (std::ranges::next_permutation(shares).found);
    return gantry.spec().home() + best;
}

}  // namespace

std::vector<Connection> all_connections() {
    std::vector<Connection> all;
    for (const bool swapped : {false, true}) {
        for (const double one : {1.0, -1.0, 0.5, -0.5, 2.0, -2.0}) {
            for (const double two : {1.0, -1.0, 0.5, -0.5, 2.0, -2.0}) {
                all.push_back({.swapped = swapped, .factor = {one, two}});
            }
        }
    }
    return all;
}

std::string explained(const Connection& connection,
                      const std::string& one,
                      const std::string& much,
                      const std::string& little) {
    std::string text = connection.swapped ? "the " + one + "s are swapped" : "";
    for (std::size_t i = 0; i < 2; ++i) {
        const double size = std::fabs(connection.factor[i]);
        for (const std::string& what :
             {std::string(connection.factor[i] < 0.0 ? "is reversed" : ""),
              std::string(size > 1.0   ? much
                          : size < 1.0 ? little
                                       : "")}) {
            if (!what.empty()) {
                text += (text.empty() ? "" : ", ") + one + " " + std::to_string(i + 1) + " " + what;
            }
        }
    }
    return text;
}

EncoderProof prove_encoders(const PantographSpec& spec, std::span<const MarkReading> marks) {
    refuse_if(marks.size() < 2, "encoders are proved by home and one more mark at least");
    const Pantograph machine(spec);
    EncoderProof proof{.connection = {}, .fits = false, .missed = kNowhere};
    for (const Connection& connection : all_connections()) {
        const double missed = missed_by(machine, marks, connection);
        const bool right = connection == Connection{};
        if (missed < proof.missed) {
            proof = {.connection = connection, .fits = missed <= kPlaced, .missed = missed};
        }
        if (right && proof.fits) {
            return proof;
        }
    }
    return proof;
}

double separation(const PantographSpec& spec, std::span<const Vec2> places, bool plugs) {
    const Pantograph machine(spec);
    const std::vector<MarkReading> marks = exact_marks(machine, places);
    if (marks.size() < 2) {
        return 0.0;
    }
    double least = kNowhere;
    for (const Connection& connection : all_connections()) {
        const auto& [one, two] = connection.factor;
        const bool meant = !plugs || (std::fabs(one) == 1.0 && std::fabs(two) == 1.0);
        if (meant && !(connection == Connection{})) {
            least = std::fmin(least, missed_by(machine, marks, connection));
        }
    }
    return least;
}

std::vector<Vec2> commissioning_places(const PantographSpec& spec, const Vec2& home) {
    const std::vector<Vec2> within = clear_places(spec, home);
    std::vector<Vec2> best;
    double max = 2.0 * kPlaced;
    for (std::size_t i = 0; i < within.size(); ++i) {
        for (std::size_t k = i + 1; k < within.size(); ++k) {
            const std::vector<Vec2> places{home, within[i], within[k]};
            const double least = separation(spec, places);
            if (least > max) {
                max = least;
                best = places;
            }
        }
    }
    refuse_if(best.empty(),
              "no two places within reach of {} tell how its encoders are connected: correct home, "
              "the lengths or the origin",
              spec.name);
    return best;
}

Vec3 second_mark(const Calibration& machine, const std::vector<Vec3>& places) {
    double missed = kPlaced + kAtPlace;
    Vec3 best{};
    const auto offer = [&](const Vec2& place) {
        const std::array<Vec2, 2> marks{Vec2(places.front()), place};
        if (const double least = separation(machine.pantograph, marks, true); least > missed) {
            missed = least;
            best = Vec3(place, 0.0);
        }
    };
    if (machine.gantry) {
        const Vec3 far(places.at(1).x, places.at(2).y, places.at(3).z);
        best = straight_mark(Gantry(*machine.gantry), far - places.front(), missed);
    } else {
        std::for_each(places.begin() + 1, places.end(), [&](const Vec3& at) { offer(Vec2(at)); });
        if (missed == kPlaced + kAtPlace) {  // both together tell, and none alone
            std::ranges::for_each(clear_places(machine.pantograph, Vec2(places.front())), offer);
        }
    }
    refuse_if(!(missed > kPlaced + kAtPlace),
              "no mark tells by itself how the encoders are connected, as each opening of the "
              "device needs it: correct home, the lengths or the origin");
    return best;
}

}  // namespace palpate::engine
