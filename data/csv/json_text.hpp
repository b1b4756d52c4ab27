#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace palpate::data {

/// A JSON value; members stay in their order.
using Json = nlohmann::ordered_json;

/// On several lines, indented by two, with all escapes of RFC 8259 and those of what a terminal
/// would obey. Bytes that are no UTF-8 become U+FFFD, numbers that are not finite null.
[[nodiscard]] std::string json_text(const Json& value);
/// The same of one string, in quotes.
[[nodiscard]] std::string json_string(std::string_view text);

}  // namespace palpate::data
