#pragma once

#include <string>

#include "data/store/database.hpp"

namespace palpate::tests {

/// The first column of the first row that a file gives, as text; empty where there is none.
inline std::string sql_first(const std::string& file, const std::string& query) {
    data::Database database(file, data::Access::read);
    auto row = database.prepare(query);
    return row.step() ? row.text(0) : "";
}

/// The first column of all its rows, a line each.
inline std::string sql_lines(const std::string& file, const std::string& query) {
    data::Database database(file, data::Access::read);
    std::string text;
    for (const auto& row : database.prepare(query)) {
        text += row.text(0) + '\n';
    }
    return text;
}

}  // namespace palpate::tests
