#include "engine/device/drivers/port_holder.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <vector>

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace palpate::engine {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kFirstTerminal = 136;  ///< major numbers of pseudo-terminals: 256 each
constexpr unsigned kTerminals = 8;

bool is_pseudo(const struct stat& port) noexcept {
    return major(port.st_rdev) - kFirstTerminal < kTerminals;
}

/// Pseudo-terminals of two containers have the same numbers.
bool is_same(const struct stat& port, const struct stat& open) noexcept {
    return S_ISCHR(open.st_mode) && open.st_rdev == port.st_rdev &&
           (!is_pseudo(port) || open.st_dev == port.st_dev);
}

/// The value after `name` in a file of lines "name:	value".
std::string value_of(const fs::path& file, const std::string& name) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with(name + ":")) {
            const std::size_t from = line.find_first_not_of(" \t", name.size() + 1);
            return from == std::string::npos ? std::string() : line.substr(from);
        }
    }
    return {};
}

/// What is in a folder of /proc, whose processes come and go meanwhile.
std::vector<fs::path> entries(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        found.push_back(at->path());
    }
    return found;
}

/// Whether a process has the port open and not its other end.
bool holds(const fs::path& process, const struct stat& port) {
    const std::string index =
        std::to_string((major(port.st_rdev) - kFirstTerminal) * 256U + minor(port.st_rdev));
    bool open = false;
    for (const fs::path& file : entries(process / "fd")) {
        struct stat what {};
        if (stat(file.c_str(), &what) != 0) {
            continue;
        }
        open = open || is_same(port, what);
        const bool master = S_ISCHR(what.st_mode) && what.st_rdev == makedev(5, 2);
        if (is_pseudo(port) && master &&
            value_of(process / "fdinfo" / file.filename(), "tty-index") == index) {
            return false;
        }
    }
    return open;
}

}  // namespace

std::string port_holder(const std::string& path) {
    struct stat port {};
    if (stat(path.c_str(), &port) != 0 || !S_ISCHR(port.st_mode)) {
        return {};
    }
    const std::string self = std::to_string(getpid());
    for (const fs::path& process : entries("/proc")) {
        const std::string id = process.filename().string();
        if (!std::all_of(id.begin(), id.end(),
                         [](unsigned char c) { return std::isdigit(c) != 0; }) ||
            id == self || !holds(process, port)) {
            continue;
        }
        const fs::path status = process / "status";
        if (value_of(status, "PPid") != self) {
            return value_of(status, "Name") + " (process " + id + ")";
        }
    }
    return {};
}

}  // namespace palpate::engine
