#include "data/store/synced.hpp"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace palpate::data {

bool sync_to_disk(const std::filesystem::path& what) {
    const int fd = open(what.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const int error = fsync(fd) == 0 ? 0 : errno;
    close(fd);
    errno = error;
    return error == 0;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    const std::filesystem::path parent = file.parent_path();
    return parent.empty() ? "." : parent;
}

}  // namespace palpate::data
