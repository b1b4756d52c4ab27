#include "data/store/migration.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/store/database.hpp"
#include "data/store/schema.hpp"
#include "data/store/synced.hpp"
#include "data/store/uuid.hpp"

namespace palpate::data {
namespace {

void sql_derived_uuid(sqlite3_context* context, int /*count*/, sqlite3_value** values) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_value_text(values[0]));
    const auto size = static_cast<std::size_t>(sqlite3_value_bytes(values[0]));
    const std::string uuid = derived_uuid(text == nullptr ? "" : std::string_view(text, size));
    sqlite3_result_text(context, uuid.c_str(), -1, SQLITE_TRANSIENT);
}

std::string free_name(const std::string& file, std::int64_t version) {
    std::string name = fmt::format("{}.schema{}.backup", file, version);
    for (int i = 2; std::filesystem::exists(name); ++i) {
        name = fmt::format("{}.schema{}.backup.{}", file, version, i);
    }
    return name;
}

/// Into an empty file of ours: SQLite would make one that others can read.
std::string copy_into(const std::string& file, const std::string& part) {
    const int fd = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR);
    if (fd < 0) {
        return std::strerror(errno);
    }
    close(fd);
    sqlite3* reader = nullptr;
    std::string error;
    char* sql = sqlite3_mprintf("VACUUM INTO %Q", part.c_str());
    if (sqlite3_open_v2(file.c_str(), &reader, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK ||
        sqlite3_exec(reader, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
        error = sqlite3_errmsg(reader);
    }
    sqlite3_free(sql);
    sqlite3_close_v2(reader);
    return error;
}

}  // namespace

void migrate(Database& database, std::int64_t from) {
    sqlite3_create_function_v2(database.handle(), "derived_uuid", 1,
                               SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_DIRECTONLY, nullptr,
                               sql_derived_uuid, nullptr, nullptr, nullptr);
    for (std::int64_t at = from; at < kSchemaVersion; ++at) {
        database.execute(std::string(migration_sql(at)).c_str());
    }
}

std::string back_up(const std::string& file, std::int64_t version) {
    const std::string name = free_name(file, version);
    const std::string part = name + ".part";
    std::string error = copy_into(file, part);
    if (error.empty() && (!sync_to_disk(part) || rename(part.c_str(), name.c_str()) != 0)) {
        error = std::strerror(errno);
    }
    if (!error.empty()) {
        unlink(part.c_str());
        throw StoreError(
            fmt::format("{}: it was made by an older palpate, and the copy of it that must be kept "
                        "first could not "
                        "be written to {}: {}; free some space there, or choose another folder",
                        file, name, error));
    }
    static_cast<void>(sync_to_disk(folder_of(name)));  // some network disks cannot
    return name;
}

}  // namespace palpate::data
