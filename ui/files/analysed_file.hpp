#pragma once

#include <string>

#include "data/store/database.hpp"

namespace palpate::ui {

/// From here on the file is seen as analyses see it (data/store/analysed.hpp); what they leave out is said on the
/// standard error, where it does not get between numbers.
/// @param versions  "apart" or "together"
/// @param codes     people by the lab's codes
void analyse(data::Database& database,
             const std::string& versions,
             const std::string& study,
             bool codes);

}  // namespace palpate::ui
