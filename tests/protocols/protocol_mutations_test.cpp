#include "protocols/file/protocol_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/placed_lines.hpp"
#include "tests/support/random.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate::protocols;
using palpate::tests::Random;

namespace {

/// Bytes and words that break things: signs, brackets, quotes, numbers at the edges, no UTF-8.
constexpr std::array<std::string_view, 46> kSplinters{"-",
                                                      "[",
                                                      "]",
                                                      "[[",
                                                      "\"",
                                                      "'''",
                                                      "=",
                                                      "#",
                                                      "\n",
                                                      "\r",
                                                      ".",
                                                      ",",
                                                      "nan",
                                                      "inf",
                                                      "1e999",
                                                      "9223372036854775808",
                                                      "0x",
                                                      "1_0",
                                                      "{",
                                                      "}",
                                                      "\xff",
                                                      "\xc3",
                                                      "\x01",
                                                      "true",
                                                      "1979-05-27",
                                                      "\\u0000",
                                                      "first_order",
                                                      "blocks = 2\n",
                                                      "[[object.segment]]\n",
                                                      "set = \"five_shapes\"\n",
                                                      "size = 2\n",
                                                      "turn_deg = 90\n",
                                                      "offset_mm = [3, -3]\n",
                                                      "friction_blocks = \"abba\"\n",
                                                      "[exclusion]\n",
                                                      "catch_correct_min = 0.5\n",
                                                      "[procedure]\n",
                                                      "[[run]]\nname = \"third\"\n",
                                                      "[response]\n",
                                                      "kind = \"rating\"\n",
                                                      "kind = \"psi\"\n",
                                                      "varies = \"mu\"\n",
                                                      "[procedure.prior]\n",
                                                      "[[procedure.staircase]]\n",
                                                      "standard_friction = \"on\"\n",
                                                      "levels = 5\n"};

/// Tables that the default study leaves out.
constexpr std::string_view kYounger =
    "[masking]\nnoise = \"pink\"\nlevel_db = -24\n[instructions.en]\nwelcome = "
    "\"Feel.\\nAnswer.\"\n"
    "[instructions.tr]\nwelcome = \"Hissedin.\"\nbreak = \"Mola\"\n";

std::string mutated(std::string text, Random& random) {
    const auto somewhere = [&] {
        return static_cast<std::size_t>(random.below(static_cast<int>(text.size())));
    };
    const int changes = 1 + random.below(4);
    for (int i = 0; i < changes && !text.empty(); ++i) {
        switch (random.below(6)) {
            case 0:
                text[somewhere()] = static_cast<char>(random.below(256));
                break;
            case 1:
                text.erase(somewhere(), 1);
                break;
            case 2:
                text.erase(somewhere(), static_cast<std::size_t>(random.below(200)));
                break;
            case 3:
                text.insert(somewhere(), kSplinters[static_cast<std::size_t>(
                                             random.below(static_cast<int>(kSplinters.size())))]);
                break;
            case 4: {
                const std::string piece =
                    text.substr(somewhere(), static_cast<std::size_t>(random.below(120)));
                text.insert(somewhere(), piece);
                break;
            }
            default: {
                // Another digit is the change that gets furthest.
                const std::size_t digit = text.find_first_of("0123456789", somewhere());
                if (digit != std::string::npos) {
                    text[digit] = static_cast<char>('0' + random.below(10));
                }
            }
        }
    }
    return text;
}

}  // namespace

TEST_CASE("no file, however broken, does more than be refused line by line", "[protocol][fuzz]") {
    const std::string file = GENERATE(
        as<std::string>{}, "protocols/library/shape_friction.toml", "tests/golden/free_forms.toml",
        "protocols/library/curvature_2afc.toml", "protocols/library/friction_threshold.toml");
    std::string study = palpate::tests::slurp(std::filesystem::path(PALPATE_SOURCE_DIR) / file);
    study += kYounger;
    int accepted = 0;
    for (std::uint64_t seed = 0; seed < palpate::tests::cases(1000U); ++seed) {
        Random random(seed);
        const std::string text = mutated(study, random);
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
    CHECK(accepted > palpate::tests::cases(file.starts_with("tests") ? 30 : 100));
    CHECK(accepted < palpate::tests::cases(900));
}
