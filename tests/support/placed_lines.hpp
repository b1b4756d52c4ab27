#pragma once

#include "tests/support/catch.hpp"

namespace palpate::tests {

/// Each line of a refusal begins with FILE:LINE:COLUMN: and goes on.
inline void check_places(const std::string& refusal) {
    std::istringstream lines(refusal);
    for (std::string line; std::getline(lines, line);) {
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

}  // namespace palpate::tests
