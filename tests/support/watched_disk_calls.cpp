#undef _FORTIFY_SOURCE  // it would put functions of the same names into the headers
#include <cstdarg>

#include <sys/stat.h>
#include <sys/syscall.h>

#include "tests/support/watched_disk_state.hpp"

namespace palpate::tests {
namespace {

using State = WatchedDisk::State;
using Kind = DiskCall::Kind;

/// `plain()` where nobody watches, else `seen(state)`, alone.
template <class Plain, class Seen>
auto call(const Plain& plain, const Seen& seen) {
    if (watched_disk == nullptr) {
        return plain();
    }
    const std::scoped_lock lock(watch_guard);
    State* const state = watched_disk;
    return state == nullptr ? plain() : seen(*state);
}

/// Numbers the name's last six letters until `make` finds it free, as the C library draws them.
template <class Make>
int with_new_name(char* name, const Make& make) {
    constexpr std::size_t kLetters = 6;
    static std::atomic<unsigned> number = 0;
    for (;;) {
        const std::string letters = std::to_string(100'000 + number++ % 900'000);
        letters.copy(name + std::strlen(name) - kLetters, kLetters);
        const int made = make();
        if (made >= 0 || errno != EEXIST) {
            return made;
        }
    }
}

int open_file(const char* path, int flags, mode_t mode) {
    const auto plain = [&] {
        return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
    };
    return call(plain, [&](State& state) {
        const auto below = state.below(path);
        int node = below ? state.node_of(*below) : -1;
        const bool makes = below && node < 0 && (flags & O_CREAT) != 0;
        if (makes && state.fails()) {
            return -1;
        }
        const int fd = plain();
        if (fd < 0) {
            return fd;
        }
        state.open.erase(fd);
        if (makes) {
            node = state.makes(*below, Kind::make_file);
        } else if (node >= 0 && (flags & O_TRUNC) != 0) {
            state.log.push_back({.kind = Kind::resize, .node = node});
            state.grows(node, 0);
        }
        if (node >= 0) {
            state.open[fd] = node;
        }
        return fd;
    });
}

ssize_t write_file(int fd, const void* bytes, std::size_t size, std::int64_t at) {
    const auto plain = [&] {
        return static_cast<ssize_t>(at < 0 ? syscall(SYS_write, fd, bytes, size)
                                           : syscall(SYS_pwrite64, fd, bytes, size, at));
    };
    return call(plain, [&](State& state) -> ssize_t {
        const int node = state.node_of(fd);
        if (node < 0) {
            return plain();
        }
        if (state.fails()) {
            return -1;
        }
        const std::int64_t from = at < 0 ? lseek(fd, 0, SEEK_CUR) : at;
        const std::int64_t can = std::max(state.sizes[node], state.sizes[node] + state.room) - from;
        if (can <= 0 && size > 0) {
            errno = ENOSPC;
            return -1;
        }
        size = std::min(size, static_cast<std::size_t>(can));
        const ssize_t written = plain();
        if (written > 0) {
            state.log.push_back(
                {.kind = Kind::write,
                 .node = node,
                 .at = from,
                 .text = {static_cast<const char*>(bytes), static_cast<std::size_t>(written)}});
            state.grows(node, std::max(state.sizes[node], from + written));
        }
        return written;
    });
}

int resize_file(int fd, std::int64_t size) {
    const auto plain = [&] {
        return static_cast<int>(syscall(SYS_ftruncate, fd, size));
    };
    return call(plain, [&](State& state) {
        const int node = state.node_of(fd);
        if (node >= 0 && state.fails()) {
            return -1;
        }
        const int done = plain();
        if (node >= 0 && done == 0) {
            state.log.push_back({.kind = Kind::resize, .node = node, .at = size});
            state.grows(node, size);
        }
        return done;
    });
}

int sync_file(int fd, long number) {
    const auto plain = [&] {
        return static_cast<int>(syscall(number, fd));
    };
    return call(plain, [&](State& state) {
        const int node = state.node_of(fd);
        if (node < 0) {
            return plain();
        }
        if (state.fails()) {
            return -1;
        }
        state.log.push_back({.kind = Kind::sync, .node = node});
        return 0;
    });
}

int remove_file(const char* path, bool folder) {
    const auto plain = [&] {
        return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, folder ? AT_REMOVEDIR : 0));
    };
    return call(plain, [&](State& state) {
        const auto below = state.below(path);
        const int node = below ? state.node_of(*below) : -1;
        if (node >= 0 && state.fails()) {
            return -1;
        }
        const int done = plain();
        if (node >= 0 && done == 0) {
            state.names(*below, -1);
            state.paths.erase(*below);
            state.let_go(node);
        }
        return done;
    });
}

int make_folder(const char* path, mode_t mode) {
    const auto plain = [&] {
        return static_cast<int>(syscall(SYS_mkdirat, AT_FDCWD, path, mode));
    };
    return call(plain, [&](State& state) {
        const auto below = state.below(path);
        if (below && state.fails()) {
            return -1;
        }
        const int done = plain();
        if (below && done == 0) {
            state.makes(*below, Kind::make_folder);
        }
        return done;
    });
}

int rename_file(const char* from, const char* to) {
    const auto plain = [&] {
        return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
    };
    return call(plain, [&](State& state) {
        const auto old_name = state.below(from);
        const auto new_name = state.below(to);
        const int node = old_name ? state.node_of(*old_name) : -1;
        if (node >= 0 && state.fails()) {
            return -1;
        }
        const int done = plain();
        if (node >= 0 && new_name && done == 0) {
            state.names(*new_name, node, *old_name);
            const int replaced = state.node_of(*new_name);
            state.paths.erase(*new_name);
            state.moves(*old_name, *new_name);
            if (replaced >= 0) {
                state.let_go(replaced);
            }
        }
        return done;
    });
}

/// Takes the room; the file only gets long.
int allocate_file(int fd, std::int64_t at, std::int64_t size) {
    const auto plain = [&] {
        return syscall(SYS_fallocate, fd, 0, at, size) == 0 ? 0 : errno;
    };
    return call(plain, [&](State& state) {
        const int node = state.node_of(fd);
        if (node < 0) {
            return plain();
        }
        if (state.fails()) {
            return errno;
        }
        const std::int64_t all = std::max(state.sizes[node], at + size);
        if (all - state.sizes[node] > state.room) {
            return ENOSPC;
        }
        if (syscall(SYS_ftruncate, fd, all) != 0) {
            return errno;
        }
        state.log.push_back({.kind = Kind::resize, .node = node, .at = all});
        state.grows(node, all);
        return 0;
    });
}

mode_t mode_of(int flags, va_list rest) {
    return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
}

}  // namespace
}  // namespace palpate::tests

// NOLINTBEGIN: these are the C library's names.
using namespace palpate::tests;

#pragma GCC visibility push(default)  // or shared libraries would not find them
extern "C" {

int open(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = mode_of(flags, rest);
    va_end(rest);
    return open_file(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = mode_of(flags, rest);
    va_end(rest);
    return open_file(path, flags, mode);
}
int close(int fd) {
    const auto plain = [fd] {
        return static_cast<int>(syscall(SYS_close, fd));
    };
    return call(plain, [&](State& state) {
        if (const int node = state.node_of(fd); node >= 0) {
            state.open.erase(fd);
            state.let_go(node);
        }
        return plain();
    });
}
ssize_t write(int fd, const void* bytes, size_t size) {
    return write_file(fd, bytes, size, -1);
}
ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
    return write_file(fd, bytes, size, at);
}
ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t at) {
    return write_file(fd, bytes, size, at);
}
int ftruncate(int fd, off_t size) noexcept {
    return resize_file(fd, size);
}
int ftruncate64(int fd, off64_t size) noexcept {
    return resize_file(fd, size);
}
int posix_fallocate(int fd, off_t at, off_t size) {
    return allocate_file(fd, at, size);
}
int posix_fallocate64(int fd, off64_t at, off64_t size) {
    return allocate_file(fd, at, size);
}
int fsync(int fd) {
    return sync_file(fd, SYS_fsync);
}
int fdatasync(int fd) {
    return sync_file(fd, SYS_fdatasync);
}
int unlink(const char* path) noexcept {
    return remove_file(path, false);
}
int rmdir(const char* path) noexcept {
    return remove_file(path, true);
}
int mkdir(const char* path, mode_t mode) noexcept {
    return make_folder(path, mode);
}
int rename(const char* from, const char* to) noexcept {
    return rename_file(from, to);
}
int mkostemp(char* name, int flags) {
    return with_new_name(name, [&] {
        return open_file(name, O_RDWR | O_CREAT | O_EXCL | flags, S_IRUSR | S_IWUSR);
    });
}
char* mkdtemp(char* name) noexcept {
    return with_new_name(name, [&] { return make_folder(name, S_IRWXU); }) < 0 ? nullptr : name;
}
}
#pragma GCC visibility pop
// NOLINTEND
