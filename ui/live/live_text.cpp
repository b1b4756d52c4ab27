#include "ui/live/live_text.hpp"

#include <nlohmann/json.hpp>

namespace palpate::ui {
namespace {

template <class Value>
data::Json value_or_null(const Value& value) {
    return value ? data::Json(*value) : data::Json(nullptr);
}

}  // namespace

std::string one_line(const data::Json& value) {
    return value.dump(-1, ' ', true, data::Json::error_handler_t::replace);
}

data::Json json_or_null(const std::string& text) {
    return text.empty() ? data::Json(nullptr) : data::Json(text);
}

data::Json json_or_null(std::optional<double> number) {
    return value_or_null(number);
}

data::Json json_or_null(std::optional<std::size_t> number) {
    return value_or_null(number);
}

data::Json json_or_null(std::optional<bool> value) {
    return value_or_null(value);
}

}  // namespace palpate::ui
