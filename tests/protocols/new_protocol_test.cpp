#include "protocols/design/plan_summary.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/new_protocol.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::protocols;

TEST_CASE("a new protocol is the shipped one but for id and title, with all its comments",
          "[protocol][law]") {
    for (const ShippedProtocol& shipped : shipped_protocols()) {
        CAPTURE(shipped.name);
        const std::string text = new_protocol(shipped, "my_study");
        Protocol made = parse_protocol(text, "my_study.toml");
        const Protocol from = parse_protocol(shipped.text, shipped.name);
        CHECK(made.id == "my_study");
        CHECK(made.title == "My study");
        CHECK(protocol_hash(made) != protocol_hash(from));
        made.id = from.id;
        made.title = from.title;
        CHECK(made == from);
        const auto hashes = [](std::string_view lines) {
            return std::count(lines.begin(), lines.end(), '#');
        };
        CHECK(hashes(text) == hashes(shipped.text) + 3);
    }
}

TEST_CASE("whatever a file is called, the study gets an id that a protocol may have",
          "[protocol][law]") {
    CHECK(id_of("My study-2") == "my_study_2");
    CHECK(id_of("şekil") == "ekil");
    CHECK(id_of("..") == "study");
    CHECK(id_of("") == "study");
    const ShippedProtocol& shipped = shipped_protocol("shape_friction_demo");
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed);
        std::string name;
        for (int i = random.below(90); i > 0; --i) {
            name += static_cast<char>(random.below(256));
        }
        CAPTURE(seed, name);
        const std::string id = id_of(name);
        CHECK(parse_protocol(new_protocol(shipped, id), "p.toml").id == id);
    }
}

TEST_CASE("a protocol that does not ship is refused with those that do", "[protocol]") {
    CHECK_THROWS_WITH(shipped_protocol("shape"), Has("\"shape\"") && Has("shape_friction_haply"));
}

TEST_CASE("the duration adds what every trial and every break take", "[duration]") {
    // By hand: 114 trials, breaks before the main phase and after 20, 40, 60, 80 and 100 of 104: 6.
    // Around the exploration: 2 * 0.2 s of ramp, 1.5 s of gap, 2 s to get ready, 3 s to choose.
    const Protocol study = parse_protocol(shipped_protocol("shape_friction").text, "p.toml");
    const Plan plan = make_plan(study, protocol_hash(study), {.participant = "p01"}, study.seed);
    const Duration duration = duration_of(plan, study);
    CHECK_THAT(duration.shortest, Catch::Matchers::WithinRel(114 * 3.9 + 180.0, 1e-12));
    CHECK_THAT(duration.prompted, Catch::Matchers::WithinRel(114 * 36.9 + 180.0, 1e-12));
    CHECK_THAT(duration.longest, Catch::Matchers::WithinRel(114 * 51.9 + 180.0, 1e-12));
}
