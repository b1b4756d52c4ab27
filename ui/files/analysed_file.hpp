#pragma once

#include <string>

#include "data/store/database.hpp"

namespace palpate::ui {

/// From here on the file is seen as analyses see it (data/store/analysed.hpp).
/// @param versions  "apart" or "together"
void analyse(data::Database& database, const std::string& versions, const std::string& study = "");

}  // namespace palpate::ui
