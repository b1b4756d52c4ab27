#include "ui/rig/json_line.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace palpate::ui {

using data::Json;

std::string one_line(const Json& value) {
    return value.dump(-1, ' ', true, Json::error_handler_t::replace);
}

Json object_in(std::string_view line) {
    Json value = Json::parse(line, nullptr, false);
    return value.is_object() ? value : Json::object();
}

std::string event_text(std::string_view name, const Json& data) {
    return fmt::format("event: {}\ndata: {}\n\n", name, one_line(data));
}

std::string answer_of(bool ok, std::string_view text, std::string_view word) {
    Json answer{{"ok", ok}, {"text", text}};
    if (!word.empty()) {
        answer["word"] = word;
    }
    return one_line(answer);
}

Json json_or_null(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

template <class Value>
Json json_or_null(const std::optional<Value>& value) {
    return value ? Json(*value) : Json(nullptr);
}
template Json json_or_null(const std::optional<double>&);
template Json json_or_null(const std::optional<std::int64_t>&);
template Json json_or_null(const std::optional<std::size_t>&);
template Json json_or_null(const std::optional<bool>&);

}  // namespace palpate::ui
