#include "protocols/file/scene_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"

// The god-object slides to the first place of its way that lies in its friction cone, and nowhere
// further: scenes in which earlier walks of ours went wrong, two or three ticks each, with the
// place that the exact law gives. Some of their outlines cross themselves, which `palpate render`
// refuses: the engine is asked.

namespace {

using Row = std::map<std::string, std::string>;

double number(const Row& row, const std::string& name) {
    return std::stod(row.at(name));
}

/// The answer of a tick of a path.
engine::Contact felt(const std::string& file, std::size_t tick) {
    const protocols::SceneFile scene =
        protocols::parse_scene(slurp(file + ".toml"), file + ".toml", protocols::Crossings::taken);
    const std::vector<Row> path = csv_records(slurp(file + ".csv"));
    const double period = path.size() > 1 ? number(path[1], "t_s") - number(path[0], "t_s") : 0.001;
    const engine::Scene felt(std::make_shared<const engine::Outline>(protocols::outline_of(scene)),
                             protocols::spec_of(scene, period));
    engine::ContactState state;
    engine::Contact contact;
    for (std::size_t i = 0; i <= tick; ++i) {
        contact = felt.tick(state, {number(path.at(i), "x_m"), number(path.at(i), "y_m")});
    }
    return contact;
}

}  // namespace

TEST_CASE("the god-object stops at the first place in its cone, in the scenes that were hardest") {
    const std::string folder = PALPATE_SOURCE_DIR "/tests/golden/first_root/";
    const std::vector<Row> cases = csv_records(slurp(folder + "expected.csv"));
    REQUIRE(cases.size() >= 18);
    for (const Row& expected : cases) {
        const std::string& scene = expected.at("scene");
        CAPTURE(scene);
        const engine::Contact contact = felt(folder + scene, std::stoul(expected.at("tick")));
        if (expected.at("what") == "free") {
            CHECK(contact.mode == engine::Mode::free);
            CHECK(contact.normal_force == 0.0);
            continue;
        }
        CHECK(contact.mode != engine::Mode::free);
        const double apart = std::hypot(contact.go.x - number(expected, "go_x_m"),
                                        contact.go.y - number(expected, "go_y_m"));
        CHECK(apart <= number(expected, "tolerance_m"));
        CHECK(contact.held() == (expected.at("what") == "held"));
        CHECK_FALSE(contact.vertex_slew);
        CHECK_FALSE(contact.unproven);
    }
}
