#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/store/database.hpp"

// What becomes of a file that somebody deletes while it is in use.
namespace palpate::data {
namespace {

/// This process has the file, or its log, open under that name, and somebody deleted the name.
bool was_deleted(const std::string& path) {
    std::error_code unknown;
    const auto open = std::filesystem::directory_iterator("/proc/self/fd", unknown);
    return std::ranges::any_of(open, [&](const auto& descriptor) {
        const std::string target = std::filesystem::read_symlink(descriptor, unknown).string();
        return target == path + " (deleted)" || target == path + "-wal (deleted)";
    });
}

/// An empty file, of nobody else.
bool made_private(const std::string& name) {
    const int made = open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, S_IRUSR | S_IWUSR);
    return made >= 0 && close(made) == 0;
}

}  // namespace

void Database::rescue_deleted() {
    if (in_memory_ || !was_deleted(sqlite3_db_filename(connection_.handle, "main"))) {
        return;
    }
    // Nor at the end, when SQLite would also delete whatever has its log's name then.
    sqlite3_db_config(connection_.handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    if (rescued_.empty()) {
        std::string name = connection_.file + ".rescued";
        for (int i = 2; !made_private(name) && errno == EEXIST; ++i) {
            name = fmt::format("{}.rescued-{}", connection_.file, i);
        }
        try {
            run("VACUUM INTO ?1", name);
        } catch (const StoreError& e) {
            std::filesystem::remove(name);
            throw StoreError(fmt::format(
                "{}: it, or its log, was deleted while it was in use, and what was recorded could "
                "not be kept as {}: {}",
                connection_.file, name, e.what()));
        }
        rescued_ = std::move(name);
    }
    throw StoreError(
        fmt::format("{}: it, or its log, was deleted while it was in use; all that was recorded is "
                    "in {}: put that in its place and run again",
                    connection_.file, rescued_));
}

}  // namespace palpate::data
