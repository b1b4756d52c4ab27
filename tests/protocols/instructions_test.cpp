#include "engine/contact/closest_point.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/library/shipped.hpp"
#include "protocols/trial/start_gate.hpp"
#include "tests/support/random.hpp"
#include "tests/support/short_text.hpp"

using namespace palpate::protocols;

namespace {

const std::string kStudy = short_text("shape_friction");

Protocol shipped(std::string_view name) {
    return parse_protocol(short_text(name), name);
}

/// Within `reach` of the start, in each direction.
engine::Vec3 near(const StartGate& gate, tests::Random& random, double reach) {
    const auto off = [&] {
        return random.in(-reach, reach);
    };
    const double x = off();
    const double y = off();
    return gate.start() + engine::Vec3{x, y, gate.in_space() ? off() : 0.0};
}

}  // namespace

TEST_CASE("what a study has without saying so changes no hash, and what it says does") {
    const Protocol plain = parse_protocol(kStudy, "p");
    CHECK(to_toml(plain).find("instructions") == std::string::npos);
    const std::string hash = protocol_hash(plain);
    CHECK(protocol_hash(parse_protocol(kStudy + "[masking]\nnoise = \"none\"\n", "p")) == hash);
    CHECK(protocol_hash(parse_protocol(kStudy + "[instructions.tr]\n", "p")) == hash);
    CHECK(protocol_hash(parse_protocol(kStudy + "[masking]\nnoise = \"pink\"\n", "p")) != hash);
    CHECK(protocol_hash(
              parse_protocol(kStudy + "[instructions.tr]\nwelcome = \"Merhaba\"\n", "p")) != hash);
}

TEST_CASE("instructions are read by language, with their line breaks, and written so") {
    const Protocol protocol = parse_protocol(
        kStudy +
            "[instructions.en]\nwelcome = \"One.\\n\\nTwo \\\"quoted\\\".\"\nready = \"r\"\n"
            "explore = \"x\"\n"
            "choose = \"c\"\nbreak = \"b\"\nend = \"e\"\n"
            "[instructions.tr]\nwelcome = '''\nGöremediğiniz nesneler.\nİkinci satır.'''\n",
        "p");
    const InstructionTexts& english = protocol.instructions[0];
    CHECK(english.welcome == "One.\n\nTwo \"quoted\".");
    CHECK((english.ready == "r" && english.explore == "x" && english.choose == "c" &&
           english.rest == "b" && english.end == "e"));
    CHECK(protocol.instructions[1].welcome == "Göremediğiniz nesneler.\nİkinci satır.");
    CHECK(protocol.instructions[1].ready.empty());
    CHECK(parse_protocol(to_toml(protocol), "again") == protocol);
}

TEST_CASE("masking noise is read with its level") {
    const Protocol protocol =
        parse_protocol(kStudy + "[masking]\nnoise = \"pink\"\nlevel_db = -24.5\n", "p");
    CHECK(protocol.masking == MaskingSpec{.noise = Noise::pink, .level_db = -24.5});
    CHECK(parse_protocol(to_toml(protocol), "again") == protocol);
}

TEST_CASE("a text to be shown may have 600 bytes and eight lines, and no more") {
    const auto said = [](const std::string& end) {
        return refusal(kStudy + "[instructions.en]\nend = \"" + end + "\"\n");
    };
    const std::string longest(kMaxInstruction, 'x');
    CHECK(said(longest) == "accepted");
    CHECK_THAT(said(longest + "x"), Has(":7: end is ", "601 bytes: give 1 to 600 bytes of text"));
    CHECK(said("1\\n2\\n\\n4\\n5\\n6\\n7\\n8") == "accepted");  // more: protocol_problems.tsv
}

TEST_CASE("a trial begins within the radius of the start, and nowhere without a place") {
    const StartGate gate(shipped(GENERATE("shape_friction", "patch_friction")));
    CHECK(gate.lets_begin(gate.start()));
    tests::Random random(3);
    for (int i = 0; i < 400; ++i) {
        const engine::Vec3 place = near(gate, random, 2.0 * gate.radius());
        if (glm::length(place - gate.start()) > gate.radius()) {
            CHECK_FALSE(gate.lets_begin(place));
        }
    }
    for (const double none : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        CHECK_FALSE(gate.lets_begin({none, gate.start().y, gate.start().z}));
    }
}

TEST_CASE("inside of any object of the study no trial begins, however wide the gate") {
    Protocol protocol = shipped(GENERATE("shape_friction", "patch_friction"));
    protocol.apparatus.start_radius = 0.060;
    const StartGate gate(protocol);
    tests::Random random(5);
    int inside = 0;
    for (std::size_t i = 0; i < protocol.objects.size(); ++i) {
        for (int k = 0; k < 300; ++k) {
            const engine::Vec3 place = near(gate, random, gate.radius());
            const bool in_object =
                protocol.surface ? engine::SurfaceFeet(surface_of(protocol, protocol.objects[i]))
                                       .closest(place)
                                       .inside
                                 : engine::OutlineFeet(*outline_of(protocol, i))
                                       .closest(engine::Vec2(place))
                                       .inside;
            inside += in_object ? 1 : 0;
            if (in_object) {
                CHECK_FALSE(gate.lets_begin(place));
            }
        }
    }
    CHECK(inside > 20);
}

TEST_CASE("a gate that a protocol leaves out is open everywhere") {
    Protocol protocol = shipped("shape_friction");
    protocol.apparatus.start_radius = 0.0;
    CHECK(StartGate(protocol).lets_begin({std::nan(""), 1.0, 0.0}));
    CHECK(StartGate().lets_begin({0.0, -1.0, 0.0}));
}
