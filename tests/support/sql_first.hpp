#pragma once

#include <filesystem>
#include <string>

#include "data/store/database.hpp"

namespace palpate::tests {

/// The first column of the first row that a file gives, as text; empty where there is none.
inline std::string sql_first(const std::string& file, const std::string& query) {
    data::Database database(file, data::Access::read);
    auto row = database.prepare(query);
    return row.step() ? row.text(0) : "";
}

/// The same of a file that may not be there yet: empty until it is.
inline std::string sql_now(const std::string& file, const std::string& query) {
    try {
        return sql_first(file, query);
    } catch (const data::StoreError&) {
        return "";
    }
}

/// All its rows, a line each, with bars between the columns.
inline std::string sql_lines(const std::string& file, const std::string& query) {
    data::Database database(file, data::Access::read);
    std::string text;
    for (const auto& row : database.prepare(query)) {
        for (int i = 0; i < row.columns(); ++i) {
            text += (i == 0 ? "" : "|") + row.text(i);
        }
        text += '\n';
    }
    return text;
}

/// Changes it, as somebody with the file could.
inline void sql_edit(const std::string& file, const std::string& sql) {
    data::Database(file, data::Access::write).execute(sql.c_str());
}

/// A copy of it with all that its log holds. @return `to`
inline std::string copied(const std::string& file, const std::string& to) {
    data::Database(file, data::Access::write).checkpoint();
    std::filesystem::copy_file(file, to, std::filesystem::copy_options::overwrite_existing);
    return to;
}

}  // namespace palpate::tests
