#pragma once

#include <mutex>
#include <system_error>

#include "tests/support/disk_model.hpp"

/// What watched_disk.cpp and watched_disk_calls.cpp share.
namespace palpate::tests {

struct WatchedDisk::State {
    explicit State(const std::filesystem::path& folder)
        : root(folder.string()), before(folder), nodes(before.size()), paths(before.paths()) {
        for (const auto& [path, node] : paths) {
            std::error_code none;
            const auto size = std::filesystem::file_size(folder / path, none);
            sizes[node] = none ? 0 : static_cast<std::int64_t>(size);
        }
    }

    std::string root;
    DiskModel before;
    int nodes;
    std::map<std::string, int> paths;  ///< of all that has a name now
    std::map<int, int> open;           ///< descriptor -> node
    std::map<int, std::int64_t> sizes;
    std::vector<DiskCall> log;
    std::size_t count = 0;
    std::size_t failing = SIZE_MAX;
    int error = 0;
    bool for_good = false;
    std::int64_t room = INT64_MAX / 2;

    /// Below the watched folder: its path there, else nothing.
    [[nodiscard]] std::optional<std::string> below(const char* path) const {
        const std::string_view whole(path);
        if (whole == root) {
            return "";
        }
        if (!whole.starts_with(root) || whole[root.size()] != '/') {
            return std::nullopt;
        }
        return std::string(whole.substr(root.size() + 1));
    }
    [[nodiscard]] int node_of(const std::string& path) const {
        const auto found = paths.find(path);
        return found == paths.end() ? -1 : found->second;
    }
    [[nodiscard]] int node_of(int fd) const {
        const auto found = open.find(fd);
        return found == open.end() ? -1 : found->second;
    }
    [[nodiscard]] bool fails() {
        const std::size_t now = count++;
        if (now == failing || (for_good && now > failing)) {
            errno = error;
            return true;
        }
        return false;
    }
    /// @param gone  another path of the same folder that ends with it
    void names(const std::string& path, int child, const std::string& gone = "") {
        const std::size_t cut = path.rfind('/') + 1;  // 0: there is none
        log.push_back({.kind = DiskCall::Kind::name,
                       .node = node_of(path.substr(0, cut == 0 ? 0 : cut - 1)),
                       .text = path.substr(cut),
                       .child = child,
                       .gone = gone.substr(std::min(cut, gone.size()))});
    }
    /// Also the folders it lies in, where the C library made them by itself.
    int makes(const std::string& path, DiskCall::Kind kind) {
        if (const std::size_t cut = path.rfind('/');
            cut != std::string::npos && node_of(path.substr(0, cut)) < 0) {
            makes(path.substr(0, cut), DiskCall::Kind::make_folder);
        }
        const int node = nodes++;
        log.push_back({.kind = kind, .node = node});
        names(path, node);
        paths[path] = node;
        sizes[node] = 0;
        return node;
    }
    /// What is neither named nor open any more is free again.
    void let_go(int node) {
        const auto has = [node](const auto& entry) {
            return entry.second == node;
        };
        if (std::ranges::none_of(paths, has) && std::ranges::none_of(open, has)) {
            grows(node, 0);
        }
    }
    void grows(int node, std::int64_t size) {
        room -= size - sizes[node];
        sizes[node] = size;
    }
    /// Moves what lies below a folder with it.
    void moves(const std::string& from, const std::string& to) {
        std::map<std::string, int> moved;
        for (auto it = paths.begin(); it != paths.end();) {
            if (it->first == from || it->first.starts_with(from + '/')) {
                moved[to + it->first.substr(from.size())] = it->second;
                it = paths.erase(it);
            } else {
                ++it;
            }
        }
        paths.merge(moved);
    }
};

/// Held by whoever looks at the state: calls come from any thread.
extern std::mutex watch_guard;
extern std::atomic<WatchedDisk::State*> watched_disk;  ///< null: nobody watches

}  // namespace palpate::tests
