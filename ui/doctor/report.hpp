#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ui/doctor/check.hpp"

namespace palpate::ui {

/// "ok", "warn", "fail".
[[nodiscard]] std::string_view to_string(CheckStatus status) noexcept;

/// One check as people read it: a line, the remedy below it behind an arrow, then the picture.
[[nodiscard]] std::string as_text(const Check& check);
/// The last line: how many of each.
[[nodiscard]] std::string verdict(const std::vector<Check>& checks);

/// One JSON object: {"palpate": version, "checks": [{"name", "status", "detail", "remedy",
/// "numbers": {...}}]}. Valid whatever the texts hold: what is not UTF-8 becomes a question mark,
/// a number that is not finite becomes null.
[[nodiscard]] std::string as_json(std::string_view version, const std::vector<Check>& checks);

}  // namespace palpate::ui
