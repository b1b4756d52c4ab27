#pragma once

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace palpate::tests {

/// A JSON value; members stay in their order.
using Json = nlohmann::ordered_json;

/// What the program says to `words` and --json.
inline Json json_of(std::vector<std::string> words) {
    words.emplace_back("--json");
    return Json::parse(ran(words).out);
}
/// Of palpate fit.
inline Json fitted(std::vector<std::string> words) {
    words.insert(words.begin(), "fit");
    return json_of(std::move(words));
}

}  // namespace palpate::tests
