#pragma once

#include "tests/support/disk_model.hpp"

namespace palpate::tests {

/// Watches one folder: every call by which this process changes it is written down, in its order,
/// over all threads. What SQLite, zlib and the program itself ask of the system is caught, because
/// watched_disk_calls.cpp defines open, write, fsync, rename, ... in front of the C library's; what
/// the C library asks of itself (fopen, mkdtemp's folder) is not. Nothing is synced in earnest. One
/// at a time.
class WatchedDisk {
public:
    /// @param folder  absolute; nothing in it is open
    explicit WatchedDisk(const std::filesystem::path& folder);
    WatchedDisk(const WatchedDisk&) = delete;
    WatchedDisk& operator=(const WatchedDisk&) = delete;
    ~WatchedDisk();

    /// Ends the watch; the log stays.
    void stop();
    /// Calls so far.
    [[nodiscard]] std::size_t calls() const;
    [[nodiscard]] const std::vector<DiskCall>& log() const;
    /// As the folder was at first.
    [[nodiscard]] const DiskModel& before() const;

    /// Calls that could have failed so far.
    [[nodiscard]] std::size_t tried() const;
    /// The call of this number, from 0, of those that can, fails with `error` and does nothing;
    /// with `for_good` all after it too.
    void fail(std::size_t call, int error, bool for_good);
    /// From now on the folder's files, with those that are open without a name, can grow by `bytes`
    /// in all.
    void room(std::int64_t bytes);

    struct State;

private:
    std::unique_ptr<State> state_;
};

}  // namespace palpate::tests
