#include "protocols/file/protocol_file.hpp"
#include "tests/support/placed_lines.hpp"

using namespace palpate::protocols;

namespace {

/// Tables that the default study leaves out.
constexpr std::string_view kYounger =
    "[masking]\nnoise = \"pink\"\nlevel_db = -24\n[instructions.en]\nwelcome = "
    "\"Feel.\\nAnswer.\"\n"
    "[instructions.tr]\nwelcome = \"Hissedin.\"\nbreak = \"Mola\"\n";

}  // namespace

TEST_CASE("no file, however broken, does more than be refused line by line", "[protocol][fuzz]") {
    const std::string file = GENERATE(
        as<std::string>{}, "protocols/library/shape_friction.toml", "tests/golden/free_forms.toml",
        "protocols/library/curvature_2afc.toml", "protocols/library/friction_threshold.toml");
    std::string study = palpate::tests::slurp(std::filesystem::path(PALPATE_SOURCE_DIR) / file);
    study += kYounger;
    int accepted = 0;
    for (std::uint64_t seed = 0; seed < palpate::tests::cases(250U); ++seed) {
        Random random(seed);
        const std::string text = palpate::tests::broken(study, random);
        CAPTURE(seed, text);
        try {
            const Protocol protocol = parse_protocol(text, "p.toml");
            ++accepted;
            CHECK(parse_protocol(to_toml(protocol), "again.toml") == protocol);
        } catch (const ProtocolError& error) {
            palpate::tests::check_places(error.what());
        }
    }
    // Both ways are taken: most of the first text is comments.
    CHECK(accepted > palpate::tests::cases(file.starts_with("tests") ? 7 : 25));
    CHECK(accepted < palpate::tests::cases(225));
}
