#pragma once

#include <string_view>

namespace palpate::data {

/// What analysts read, and people without the SQL extension: all views as of schema 5.
[[nodiscard]] std::string_view views_sql() noexcept;

}  // namespace palpate::data
