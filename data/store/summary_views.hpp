#pragma once

#include <string_view>

namespace palpate::data {

/// Views since schema 5 for people without the SQL extension: trial_summary and session_health.
[[nodiscard]] std::string_view summary_views_sql() noexcept;

}  // namespace palpate::data
