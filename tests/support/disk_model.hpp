#pragma once

#include "tests/support/random.hpp"

namespace palpate::tests {

/// One call of a program that changed what is in a folder.
struct DiskCall {
    enum class Kind : std::uint8_t {
        make_file,
        make_folder,
        write,   ///< `bytes` at `at`
        resize,  ///< to `at` bytes
        sync,    ///< of a file's bytes, or of a folder's names
        /// In the folder `node`: `text` is `child` now, or nobody's (-1), and `gone` is nobody's.
        name,
    };
    Kind kind{};
    int node = 0;
    std::int64_t at = 0;
    std::string text{};  ///< bytes or name
    int child = -1;
    std::string gone{};
};

/// What a power cut leaves of what was not synced.
enum class Leaves : std::uint8_t {
    nothing,
    everything,
    some_calls,   ///< of each file the first so many calls
    sectors_512,  ///< each sector of 512 bytes as any call left it: torn and in any order
    sectors_4k,
};
inline constexpr Leaves kLeaves[] = {Leaves::nothing, Leaves::everything, Leaves::some_calls,
                                     Leaves::sectors_512, Leaves::sectors_4k};

/// Files and folders below one folder, with what of them is synced and what was done since: the
/// harshest disk that POSIX allows. A file's bytes are safe after fsync(file), its name after
/// fsync(folder), and the size is one thing, each sector another, but a resize takes effect as a
/// whole. A sector is never half written. What was added to a file and did not come through reads
/// as zeros.
class DiskModel {
public:
    /// As the folder lies there now, all of it synced. Node 0 is the folder itself.
    explicit DiskModel(const std::filesystem::path& folder);

    void apply(const DiskCall& call);

    /// Writes into the empty folder `into` what may be found after a power cut now. The index of a
    /// log (FILE-shm) is memory: it is missing or full of rubbish.
    void lay_out(Leaves leaves, Random& random, const std::filesystem::path& into) const;

    /// Nodes by their path below the folder, "" for the folder itself.
    [[nodiscard]] std::map<std::string, int> paths() const;
    [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }

private:
    struct Change {
        bool resize = false;
        std::int64_t at = 0;
        std::string bytes{};
    };
    struct Node {
        bool folder = false;
        std::string bytes{};  ///< synced
        std::vector<Change> since{};
        std::map<std::string, int> names{};  ///< synced
        std::vector<DiskCall> names_since{};
    };

    void load(int node, const std::filesystem::path& folder);
    void list(int node, const std::string& prefix, std::map<std::string, int>& all) const;
    static void play(std::string& bytes, const Change& change);
    static std::string bytes_left(const Node& node, Leaves leaves, Random& random);
    static std::map<std::string, int> names_left(const Node& node, Leaves leaves, Random& random);
    void lay_out(int node, Leaves leaves, Random& random, const std::filesystem::path& into) const;

    std::vector<Node> nodes_;
};

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
