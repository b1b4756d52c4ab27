#include "data/csv/json_text.hpp"

#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"

namespace palpate::data {

std::string json_text(const Json& value) {
    const std::string text = value.dump(2, ' ', false, Json::error_handler_t::replace);
    std::string out;
    for (std::string_view rest = text; !rest.empty();) {
        const auto [code, length] = first_character(rest);
        if (code == U'\n' || !is_order(code)) {
            out += rest.substr(0, length);
        } else {  // in a string: nothing else of JSON is one
            const std::string escaped = Json(rest.substr(0, length)).dump(-1, ' ', true);
            out += std::string_view(escaped).substr(1, escaped.size() - 2);
        }
        rest.remove_prefix(length);
    }
    return out;
}

std::string json_string(std::string_view text) {
    return json_text(text);
}

}  // namespace palpate::data
