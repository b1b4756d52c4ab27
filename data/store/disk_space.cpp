#include "data/store/disk_space.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "engine/base/text.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "data/store/database.hpp"

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

}  // namespace

constexpr double kBytesPerTick = 40.0;
constexpr double kBytesBesides = 16e6;

std::int64_t bytes_needed(const protocols::Protocol& protocol, std::size_t trials) {
    const double ticks = static_cast<double>(trials * protocols::intervals_of(protocol)) *
                         protocol.timing.explore_timeout * protocol.apparatus.rate_hz;
    return static_cast<std::int64_t>(std::ceil(ticks * kBytesPerTick + kBytesBesides));
}

std::int64_t bytes_free(const std::string& file) {
    struct statvfs disk {};
    const std::string folder = std::filesystem::absolute(file).parent_path().string();
    if (statvfs(file.c_str(), &disk) != 0 &&
        (errno != ENOENT || statvfs(folder.c_str(), &disk) != 0)) {
        throw StoreError(
            fmt::format("{}: the room on its disk is not known: {}", file, std::strerror(errno)));
    }
    return static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
}

void require_space(const std::string& file,
                   const protocols::Protocol& protocol,
                   std::size_t trials) {
    const std::int64_t there = bytes_free(file);
    const std::int64_t needed = bytes_needed(protocol, trials);
    if (there < needed) {
        throw StoreError(
            fmt::format("{}: its disk has room for {:.1f} MB, and {} may take {:.1f} MB; free some "
                        "space, or choose a file on another disk. What was recorded is kept",
                        file, static_cast<double>(there) * 1e-6, counted(trials, "trial"),
                        static_cast<double>(needed) * 1e-6));
    }
}

bool lies_still(const std::string& name) {
    std::error_code unknown;
    const std::filesystem::path file = std::filesystem::canonical(name, unknown);
    return !unknown && ::access(file.parent_path().c_str(), W_OK) != 0 &&
           ::access((file.string() + "-wal").c_str(), F_OK) != 0 &&
           ::access((file.string() + "-shm").c_str(), F_OK) != 0;
}

std::string log_of(const std::string& name) {
    std::error_code unknown;
    const std::filesystem::path file = std::filesystem::canonical(name, unknown);
    return unknown ? "" : file.string() + "-wal";
}

bool has_log(const std::string& name) {
    std::error_code unknown;
    const auto size = std::filesystem::file_size(log_of(name), unknown);
    return !unknown && size > 0;
}

void Database::rescue_deleted() {
    if (in_memory_ || !was_deleted(sqlite3_db_filename(connection_.handle, "main"))) {
        return;
    }
    // Nor at the end, when SQLite would also delete whatever has its log's name then.
    sqlite3_db_config(connection_.handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    if (rescued_.empty()) {
        std::string name = connection_.file + ".rescued";
        for (int i = 2; std::filesystem::exists(name); ++i) {
            name = fmt::format("{}.rescued-{}", connection_.file, i);
        }
        run("VACUUM INTO ?1", name);
        chmod(name.c_str(), S_IRUSR | S_IWUSR);
        rescued_ = std::move(name);
    }
    throw StoreError(
        fmt::format("{}: it, or its log, was deleted while it was in use; all that was recorded is "
                    "in {}: put that in its place and run again",
                    connection_.file, rescued_));
}

}  // namespace palpate::data
