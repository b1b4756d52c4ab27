#include "data/shell/sql_guard.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include <fmt/format.h>
#include <sqlite3.h>

#include "engine/base/text.hpp"

namespace palpate::data {
namespace {

constexpr int kStepsAtOnce = 100'000;
constexpr int kLongestValue = 50'000'000;  // bytes; the longest that palpate stores has 0.1 MB

/// bytes; what does not find room is refused, and goes to no disk
constexpr std::int64_t kMaxMemory = std::int64_t{1} << 30U;

/// Pragmas that only say something; others change the connection, the file or other files.
bool only_says(std::string_view pragma, bool with_value) {
    constexpr std::array<std::string_view, 16> kSay{
        "collation_list",    "compile_options",  "database_list",   "encoding",
        "foreign_key_check", "foreign_key_list", "function_list",   "index_info",
        "index_list",        "index_xinfo",      "integrity_check", "page_count",
        "quick_check",       "table_info",       "table_list",      "table_xinfo"};
    return std::ranges::find(kSay, pragma) != kSay.end() ||
           (!with_value && (pragma == "user_version" || pragma == "application_id"));
}

}  // namespace

SqlGuard::SqlGuard(Database& database, SqlLimits limits) : database_(database), limits_(limits) {
    begin();
    database.execute("PRAGMA temp_store = MEMORY");  // sorted rows, as many as a query makes
    sqlite3_hard_heap_limit64(kMaxMemory);
    sqlite3_limit(database.handle(), SQLITE_LIMIT_LENGTH, kLongestValue);
    sqlite3_progress_handler(database.handle(), kStepsAtOnce, count, this);
    sqlite3_set_authorizer(database.handle(), authorize, this);
}

SqlGuard::~SqlGuard() {
    sqlite3_progress_handler(database_.handle(), 0, nullptr, nullptr);
    sqlite3_set_authorizer(database_.handle(), nullptr, nullptr);
    sqlite3_hard_heap_limit64(0);
}

void SqlGuard::begin() noexcept {
    steps_left_ = limits_.steps;
    attached_ = false;
}

int SqlGuard::count(void* guard) noexcept {
    return (static_cast<SqlGuard*>(guard)->steps_left_ -= kStepsAtOnce) < 0 ? 1 : 0;
}

int SqlGuard::authorize(void* guard,
                        int action,
                        const char* first,
                        const char* second,
                        const char* /*database*/,
                        const char* /*inner*/) noexcept {
    auto& own = *static_cast<SqlGuard*>(guard);
    switch (action) {
        case SQLITE_SELECT:
        case SQLITE_READ:
        case SQLITE_RECURSIVE:
        case SQLITE_TRANSACTION:
        case SQLITE_SAVEPOINT:
            return SQLITE_OK;
        case SQLITE_FUNCTION: {
            const std::string_view name = second;
            return name == "load_extension" || name == "fts3_tokenizer" ? SQLITE_DENY : SQLITE_OK;
        }
        case SQLITE_PRAGMA:
            return only_says(first, second != nullptr) ? SQLITE_OK : SQLITE_DENY;
        case SQLITE_ATTACH:
        case SQLITE_DETACH:
            own.attached_ = true;
            return own.limits_.attach ? SQLITE_OK : SQLITE_DENY;
        case SQLITE_UPDATE:  // how SQLite declares a virtual table; who asks for it is refused by SQLite itself
            return std::string_view(first) == "sqlite_master" ? SQLITE_OK : SQLITE_DENY;
        default:
            return SQLITE_DENY;
    }
}

std::string SqlGuard::refusal(std::string_view statement) const {
    return fmt::format(
        "palpate: palpate sql only reads this file, and this would do more: {}\n  {}\n",
        plain(statement.substr(0, 60)),
        attached_ && !limits_.attach ? "--attach lets it read other files too."
                                     : "To change something take a copy of the file and sqlite3.");
}

}  // namespace palpate::data
