#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "data/csv/json_text.hpp"

/// Pieces of the JSON that goes to other programs.
namespace palpate::ui {

/// Without ends of lines and in ASCII: nothing in it is an order to a terminal.
[[nodiscard]] std::string one_line(const data::Json& value);
/// null for nothing, and for a text that is empty.
[[nodiscard]] data::Json json_or_null(const std::string& text);
[[nodiscard]] data::Json json_or_null(std::optional<double> number);
[[nodiscard]] data::Json json_or_null(std::optional<std::size_t> number);
[[nodiscard]] data::Json json_or_null(std::optional<bool> value);

}  // namespace palpate::ui
