#include "data/store/row.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "data/schema/catalogue.hpp"

namespace palpate::data {

Row::Row(std::string_view table, const Statement& row) : table_(table) {
    for (int column = 0; column < row.columns(); ++column) {
        add(row.name(column), row.value(column));
    }
}

bool Row::has(std::string_view column) const {
    const TableManual* table = find_table(table_);
    return table != nullptr && table->find(column) != nullptr;
}

Row& Row::add(std::string_view column, ColumnValue value) {
    refuse_if<std::logic_error>(!has(column), "the catalogue has no column {}.{}", table_, column);
    const auto there = std::ranges::find(values_, column, &decltype(values_)::value_type::first);
    if (there == values_.end()) {
        values_.emplace_back(column, std::move(value));
    } else {
        there->second = std::move(value);
    }
    return *this;
}

void Row::bind(Statement& statement) const {
    int parameter = 0;
    for (const auto& [name, value] : values_) {
        statement.bind(++parameter, value);
    }
}

std::int64_t Row::insert(Database& database, std::string_view conflict) const {
    std::string names;
    std::string places;
    for (const auto& [name, value] : values_) {
        names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
        places += places.empty() ? "?" : ", ?";
    }
    Statement statement = database.prepare(
        fmt::format("INSERT INTO {} ({}) VALUES ({}) {}", table_, names, places, conflict));
    bind(statement);
    statement.run();
    return database.last_row();
}

std::int64_t Row::update(Database& database, std::initializer_list<std::string_view> keys) const {
    std::string changed;
    std::string where;
    int parameter = 0;
    for (const auto& [name, value] : values_) {
        const bool key = std::ranges::find(keys, name) != keys.end();
        std::string& list = key ? where : changed;
        list += fmt::format("{}{} = ?{}",
                            list.empty() ? ""
                            : key        ? " AND "
                                         : ", ",
                            name, ++parameter);
    }
    Statement statement =
        database.prepare(fmt::format("UPDATE {} SET {} WHERE {}", table_, changed, where));
    bind(statement);
    statement.run();
    return database.changes();
}

}  // namespace palpate::data
