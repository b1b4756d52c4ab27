#pragma once

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace palpate::tests {

/// A JSON value; members stay in their order.
using Json = nlohmann::ordered_json;

/// What the program says to `words` and --json.
inline Json json_of(Words words) {
    words.emplace_back("--json");
    return Json::parse(ran(words).out);
}
/// Of palpate fit.
inline Json fitted(const Words& words) {
    return json_of(joined({"fit"}, words));
}

/// What a script of palpate stats --emit-r prints, a place of the JSON and its number a line.
/// @param spelled  what R has in place of letters   @return how many numbers of each kind
inline std::map<std::string, int> compare_with_r(
    const std::string& printed,
    const Json& ours,
    const std::vector<std::pair<std::string, std::string>>& spelled) {
    std::map<std::string, int> kinds;
    for (const std::string& line : lines_in(printed)) {
        REQUIRE_THAT(line, Has("\t"));
        std::string place = behind(line, "", "\t");
        for (const auto& [by_r, letters] : spelled) {
            place = all_replaced(std::move(place), by_r, letters);
        }
        CAPTURE(line);
        REQUIRE(ours.contains(Json::json_pointer(place)));
        const Json& number = ours.at(Json::json_pointer(place));
        REQUIRE(number.is_number());
        const bool mixed = place.find("/mixed_model/") != std::string::npos;
        const bool spread = place.find("_se") != std::string::npos ||
                            place.find("/sd_") != std::string::npos ||
                            place.find("/correlation") != std::string::npos;
        const double wanted = std::stod(behind(line, "\t"));
        const double share = !mixed ? 2e-8 : spread ? 2e-3 : 2e-4;
        CHECK(number.get<double>() == Approx(wanted).epsilon(share).margin(mixed ? 2e-5 : 1e-9));
        ++kinds[place.substr(place.find_last_of('/') + 1)];
        ++kinds[mixed ? (place.find("laplace") == std::string::npos ? "of the grid" : "of lme4")
                      : "of base R"];
    }
    return kinds;
}

}  // namespace palpate::tests
