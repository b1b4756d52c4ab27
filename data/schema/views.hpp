#pragma once

#include <string_view>

namespace palpate::data {

/// The views of the catalogue: part of schema_sql().
[[nodiscard]] std::string_view views_sql();

}  // namespace palpate::data
