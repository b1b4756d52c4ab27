#include "data/store/migration.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <sqlite3.h>

#include "data/schema/catalogue.hpp"

namespace palpate::data {
namespace {

std::int64_t version_of(const Connection& file) {
    Statement row(file, "PRAGMA user_version");
    row.step();
    return row.integer(0);
}

std::string copied(const Connection& file, std::int64_t version) {
    std::string copy = fmt::format("{}.schema-{}.sqlite", file.file, version);
    if (std::filesystem::exists(copy)) {
        throw StoreError(fmt::format(
            "{}: a copy is made before its schema changes, and {} is there already; move it away",
            file.file, copy));
    }
    Statement(file, "VACUUM INTO ?1").bind(1, std::string_view(copy)).run();
    return copy;
}

/// Views say nothing of their own, and may name what a step changes: they go first.
void drop_views(const Connection& file) {
    std::vector<std::string> views;
    Statement row(file, "SELECT name FROM sqlite_schema WHERE type = 'view'");
    while (row.step()) {
        views.push_back(row.text(0));
    }
    row.reset();
    for (const std::string& view : views) {
        file.execute(("DROP VIEW " + quoted_name(view)).c_str());
    }
}

/// All of them, in the caller's transaction.
void take(const Connection& file, std::span<const MigrationStep> steps) {
    drop_views(file);
    for (const MigrationStep& step : steps) {
        file.execute(std::string(step.sql).c_str());
        file.execute(fmt::format("PRAGMA user_version = {}", step.to).c_str());
    }
    file.execute(std::string(views_sql()).c_str());
    if (Statement(file, "PRAGMA foreign_key_check").step()) {
        throw StoreError(fmt::format(
            "{}: a row would be left without its owner by the new schema; the file is as before",
            file.file));
    }
}

}  // namespace

std::span<const MigrationStep> migration_steps() noexcept {
    return {};
}

std::string migrate(const Connection& file, std::span<const MigrationStep> steps) {
    const std::int64_t version = version_of(file);
    const auto first = std::ranges::find(steps, version + 1, &MigrationStep::to);
    if (steps.empty() || steps.back().to <= version) {
        return "";
    }
    if (first == steps.end()) {
        throw StoreError(fmt::format("{}: no step leads on from schema {}", file.file, version));
    }
    std::string copy = copied(file, version);
    file.execute("BEGIN IMMEDIATE");
    try {
        take(file, std::span(first, steps.end()));
        for (const TableManual& table : catalogue()) {  // a view may need what a step took away
            file.execute(fmt::format("SELECT * FROM {} LIMIT 0", table.name).c_str());
        }
        file.execute("COMMIT");
    } catch (...) {
        sqlite3_exec(file.handle, "ROLLBACK", nullptr, nullptr, nullptr);
        throw;
    }
    return copy;
}

}  // namespace palpate::data
