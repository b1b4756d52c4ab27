#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::data {

/// A JSON object in the making: members in their order, values as JSON text.
using JsonMembers = std::vector<std::pair<std::string, std::string>>;

/// "..." with all escapes of RFC 8259, and those of what a terminal would obey. Bytes that are no UTF-8 become
/// U+FFFD.
[[nodiscard]] std::string json_string(std::string_view text);
/// A number of number_text(); null for what is not finite.
[[nodiscard]] std::string json_number(double value);
[[nodiscard]] std::string json_object(const JsonMembers& members);
[[nodiscard]] std::string json_array(const std::vector<std::string>& values);

}  // namespace palpate::data
