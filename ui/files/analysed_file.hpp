#pragma once

#include <string>

#include "data/store/database.hpp"
#include "ui/command/command.hpp"

namespace palpate::ui {

/// --kind of the sessions meant, and how versions of a protocol are taken.
Word& add_kind(CommandWords& words, std::string& kind, std::string help);
void add_versions(CommandWords& words, std::string& versions);

/// From here on the file is seen as analyses see it (data/store/analysed.hpp).
/// @param versions  "apart" or "together"
void analyse(data::Database& database, const std::string& versions, const std::string& study = "");

}  // namespace palpate::ui
