#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::ui {

/// What a check came to.
enum class CheckStatus : std::uint8_t {
    ok,
    warn,  ///< sessions run, but something is worse than it could be
    fail,  ///< sessions will not run, or not as recorded
};

/// One line of the doctor's.
struct Check {
    std::string name;
    CheckStatus status = CheckStatus::ok;
    std::string detail;  ///< what was found, with numbers and units
    std::string remedy;  ///< what to do; empty when all is well
    std::vector<std::pair<std::string, double>> numbers;  ///< for programs: "p99_us", 35.2
    std::vector<std::string> picture;                     ///< lines below, for people only
};

/// `look`, or a failed check named `name` with what it threw.
[[nodiscard]] Check guarded(const std::string& name, const std::function<Check()>& look) noexcept;

/// Some check failed.
[[nodiscard]] bool any_fails(const std::vector<Check>& checks) noexcept;

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
