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

}  // namespace palpate::tests
