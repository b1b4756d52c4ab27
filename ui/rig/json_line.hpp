#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "data/csv/json_text.hpp"

/// JSON between programs: an object a line.
namespace palpate::ui {

/// Without ends of lines and in ASCII: nothing in it is an order to a terminal.
[[nodiscard]] std::string one_line(const data::Json& value);
/// An object; one without members where the line is none.
[[nodiscard]] data::Json object_in(std::string_view line);
/// A server-sent event of a page.
[[nodiscard]] std::string event_text(std::string_view name, const data::Json& data);
/// What became of what was asked. @param word  to be repeated; empty: none
[[nodiscard]] std::string answer_of(bool ok, std::string_view text, std::string_view word = {});

/// null for nothing, and for a text that is empty.
[[nodiscard]] data::Json json_or_null(const std::string& text);
template <class Value>
[[nodiscard]] data::Json json_or_null(const std::optional<Value>& value);

}  // namespace palpate::ui
