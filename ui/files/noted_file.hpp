#pragma once

#include <string>
#include <string_view>

#include "engine/base/refuse.hpp"
#include "data/store/database.hpp"

/// What commands that note something have in common.
namespace palpate::ui {

/// To write into a database that is there: nothing is to be made for a wrong name.
[[nodiscard]] inline data::Database open_there(const std::string& file) {
    { const data::Database there(file, data::Access::inspect); }
    return {file, data::Access::write};
}

/// @param what  "TEXT", as the message calls it
/// @throws std::invalid_argument for a text of nothing but blanks
inline void require_text(const std::string& text, std::string_view what) {
    refuse_if(text.find_first_not_of(" \t\r\n") == std::string::npos,
              "{} is empty: say it in a few words", what);
}

}  // namespace palpate::ui
