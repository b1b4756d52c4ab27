#pragma once

#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/slurp.hpp"

namespace palpate::tests {

/// Each line of a refusal begins with FILE:LINE:COLUMN: and goes on.
inline void check_places(const std::string& refusal) {
    for (const std::string& line : lines_in(refusal)) {
        CAPTURE(line);
        std::size_t colon = line.find(':');
        CHECK(colon > 0);
        for (int number = 0; number < 2 && colon != std::string::npos; ++number) {
            const std::size_t end = line.find_first_not_of("0123456789", colon + 1);
            CHECK(end > colon + 1);
            colon = end != std::string::npos && line[end] == ':' ? end : std::string::npos;
        }
        REQUIRE(colon != std::string::npos);
        CHECK(line.substr(colon + 1).size() > 1);
        CHECK(line[colon + 1] == ' ');
    }
}

/// A text that somebody or something broke in one to four places: bytes that are others, lost,
/// there twice, or words and signs that break things; another digit gets furthest.
/// @param cut  below so many bytes are lost at a time
inline std::string broken(std::string text, Random& random, int cut = 200) {
    static const Words splinters = split(
        "-|[|]|[[|\"|'''|=|#|\n|\r|.|,|nan|inf|1e999|9223372036854775808|0x|1_0|{|}|"
        "\xff|\xc3|\x01|true|1979-05-27|\\u0000|first_order|blocks = 2\n|"
        "[[object.segment]]\n|set = \"five_shapes\"\n|size = 2\n|turn_deg = 90\n|"
        "offset_mm = [3, -3]\n|friction_blocks = \"abba\"\n|[exclusion]\n|"
        "catch_correct_min = 0.5\n|[procedure]\n|[[run]]\nname = \"third\"\n|"
        "[response]\n|kind = \"rating\"\n|kind = \"psi\"\n|varies = \"mu\"\n|"
        "[procedure.prior]\n|[[procedure.staircase]]\n|standard_friction = \"on\"\n|"
        "levels = 5\n",
        '|');
    const auto somewhere = [&] {
        return random.index(text.size());
    };
    const auto below = [&](int bytes) {
        return static_cast<std::size_t>(random.below(bytes));
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
                text.erase(somewhere(), below(cut));
                break;
            case 3:
                text.insert(somewhere(), splinters[random.index(splinters.size())]);
                break;
            case 4: {
                const std::string piece = text.substr(somewhere(), below(cut * 3 / 5));
                text.insert(somewhere(), piece);
                break;
            }
            default: {
                const std::size_t digit = text.find_first_of("0123456789", somewhere());
                if (digit != std::string::npos) {
                    text[digit] = static_cast<char>('0' + random.below(10));
                }
            }
        }
    }
    return text;
}

}  // namespace palpate::tests
