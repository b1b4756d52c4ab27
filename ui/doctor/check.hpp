#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::ui {

/// What a check came to.
enum class CheckStatus : std::uint8_t {
    ok,
    warn,  ///< sessions run, but something is worse than it could be
    fail,  ///< sessions will not run, or not as recorded
};

/// One line of the doctor's. A plain value; how it looks is report.hpp's.
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

}  // namespace palpate::ui
