#include "data/store/disk_space.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "data/sql/statement.hpp"

namespace palpate::data {

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

std::string plain_name(const std::string& file) {
    return file.starts_with('/') ? file : "./" + file;
}

std::string immutable_uri(const std::string& file) {
    std::string uri = "file:";
    for (const char c : plain_name(file)) {
        const bool plain = c != '%' && c != '?' && c != '#';
        uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned>(c));
    }
    return uri + "?immutable=1";
}

bool made_private(const std::string& file) {
    const int made = open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
    return made >= 0 && close(made) == 0;
}

void require_not_elsewhere(const std::string& file) {
    std::error_code unknown;
    const std::filesystem::path name = plain_name(file);
    const auto size_of = [&](const std::string& one) {  // 0: it is empty, or not there
        const auto size = std::filesystem::file_size(one, unknown);
        return unknown ? 0 : size;
    };
    // Its log first: another program that makes the file now begins with the file.
    refuse_if<WrongFile>(size_of(name.string() + "-wal") > 0 && size_of(name) == 0,
                         "{0}: it is not there, or empty, and {0}-wal beside it is the log of a "
                         "file that was: put that file in its place, or move {0}-wal away",
                         file);
    if (std::filesystem::exists(name, unknown)) {
        return;
    }
    refuse_if<WrongFile>(unknown == std::errc::too_many_symbolic_link_levels,
                         "{}: it is a link that leads back to itself: name the file", file);
    refuse_if<WrongFile>(std::filesystem::is_symlink(name, unknown),
                         "{}: it is a link to {}, which is not there: make the link right, or take "
                         "it away",
                         file, std::filesystem::read_symlink(name, unknown).string());
    refuse_if<WrongFile>(
        std::filesystem::exists(plain_name(file) + ".rescued", unknown),
        "{0}: it is not there, and {0}.rescued beside it is what was recorded when "
        "it was deleted: put that in its place to go on with it, or move it away",
        file);
}

bool lies_still(const std::string& name) {
    std::error_code unknown;
    const std::filesystem::path file = std::filesystem::canonical(name, unknown);
    struct stat status {};
    if (unknown || stat(file.c_str(), &status) != 0) {
        return false;
    }
    const bool theirs = geteuid() != 0 && geteuid() != status.st_uid;
    const bool index = ::access((file.string() + "-shm").c_str(), F_OK) == 0;
    refuse_if<StoreError>(theirs && !index && has_log(name),
                          "{0}: its log, {0}-wal, has no index beside it, and one that you made "
                          "would keep the file's owner from writing: let them open it first",
                          name);
    return (theirs || ::access(file.parent_path().c_str(), W_OK) != 0) && !has_log(name) &&
           !(index && ::access((file.string() + "-wal").c_str(), F_OK) == 0);
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

}  // namespace palpate::data
