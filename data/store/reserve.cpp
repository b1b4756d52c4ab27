#include "data/store/reserve.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/store/disk_space.hpp"
#include "data/store/statement.hpp"

namespace palpate::data {
namespace {

constexpr std::int64_t kPiece = 1'000'000;

}  // namespace

Reserve::~Reserve() {
    if (descriptor_ >= 0) {
        close(descriptor_);
    }
}

int Reserve::take(std::int64_t bytes) {
    if (descriptor_ < 0) {
        std::error_code unknown;
        const auto there = std::filesystem::canonical(file_, unknown);  // a link may lie elsewhere
        std::string name = fmt::format("{}.room-XXXXXX", unknown ? file_ : there.string());
        descriptor_ =
            mkostemp(name.data(), O_CLOEXEC);  // no name that somebody could lay a link by
        if (descriptor_ < 0) {
            return errno;
        }
        unlink(name.c_str());
    }
    const int error = posix_fallocate(descriptor_, 0, bytes);
    if (error == 0) {
        held_ = bytes;
    } else if (ftruncate(descriptor_, held_) != 0) {  // some of it may have been there
        return errno;
    }
    return error;
}

void Reserve::hold(std::int64_t bytes) {
    if (held_ >= bytes) {
        return;
    }
    const int error = take(bytes);
    const bool none = error == ENOSPC || error == EDQUOT;
    const bool cannot = error == EOPNOTSUPP || error == EINVAL;
    if (error != 0 && !none && !cannot) {
        throw StoreError(
            fmt::format("{}: no room for a trial could be set aside beside it: {}; "
                        "check that its folder is there and may be written",
                        file_, std::strerror(error)));
    }
    if (none || (cannot && bytes_free(file_) < bytes)) {
        throw StoreError(
            fmt::format("{}: its disk does not have the {:.0f} MB that a trial may take; free some "
                        "space, or go "
                        "on with a copy on another disk. What was recorded is kept",
                        file_, static_cast<double>(bytes) * 1e-6));
    }
}

bool Reserve::give_back() {
    if (held_ == 0) {
        return false;
    }
    held_ = std::max<std::int64_t>(held_ - kPiece, 0);
    return ftruncate(descriptor_, held_) == 0;
}

}  // namespace palpate::data
