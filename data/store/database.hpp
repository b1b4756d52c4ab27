#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "data/sql/statement.hpp"

struct sqlite3;

namespace palpate::data {

enum class Access { read, write, memory, inspect };

/// Whether a file begins as those of SQLite do. False where it cannot be read.
[[nodiscard]] bool is_database(const std::string& file);

/// Connection::failed of a file: what SQLite's last error is, and what to do about it.
/// @throws StoreError, LockedFile or DiskError
[[noreturn]] void fail_with_remedy(const Connection& connection, std::string_view doing);

/// One palpate database file.
class Database {
public:
    /// write: makes the file (mode 0600) with the current schema, or opens one; WAL, every commit
    /// synced to the disk, foreign keys on. read: never changes anything, and reads from a
    /// read-only disk too. inspect: the same for a look at what is stored, whatever its schema.
    /// memory: a new one that nobody else sees, gone with this object; its name is for messages.
    /// The name is always that of a file: "" and ":memory:" have no meaning of their own.
    ///
    /// What a file brings is data, never a program: none of its triggers runs. Its schema is
    /// compared with the catalogue. write refuses a trigger on our tables and whatever of ours is
    /// another. read refuses tables of ours that are others, and damaged pages but those of ticks;
    /// for views that are others, it remarks so, makes our own and looks into none of the file's.
    /// @throws StoreError for a file that is no palpate database or has another schema (both stay
    ///         as they are, their logs too), one that cannot be opened, or whose schema is refused
    Database(std::string file, Access access);
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;
    ~Database();

    /// Runs statements without parameters; compiles one with `values` as its parameters from 1 on,
    /// or runs it. @throws StoreError
    void execute(const char* sql) { connection_.execute(sql); }
    template <class... Values>
    [[nodiscard]] Statement prepare(std::string_view sql, const Values&... values) {
        return {connection_, sql, values...};
    }
    /// The same, at the first row of a query that always has one.
    template <class... Values>
    [[nodiscard]] Statement first(std::string_view sql, const Values&... values) {
        Statement row = prepare(sql, values...);
        row.step();
        return row;
    }
    template <class... Values>
    void run(std::string_view sql, const Values&... values) {
        prepare(sql, values...).run();
    }
    /// rowid of the last INSERT.
    [[nodiscard]] std::int64_t last_row() const;
    /// Rows that the last INSERT, UPDATE or DELETE touched.
    [[nodiscard]] std::int64_t changes() const;
    [[nodiscard]] const std::string& file() const { return connection_.file; }
    [[nodiscard]] bool in_memory() const { return in_memory_; }

    /// Whose time goes into rows from here on, ns since 1970; the session of a simulated person
    /// lasts as long as it would have, and is the same whenever it is simulated. Without it: the
    /// clocks of this machine.
    void set_clock(std::function<std::int64_t()> clock) { clock_ = std::move(clock); }
    /// Now, as utc_now() says it.
    /// @param then  of monotonic_ns(): not now but then, on a clock of this machine; 0: now
    [[nodiscard]] std::string utc_now(std::int64_t then = 0) const;
    /// Now on a clock that nobody sets, ns. @param then  as utc_now()'s
    [[nodiscard]] std::int64_t steady_now(std::int64_t then = 0) const;

    /// Where this connection made the file, and nobody is in it: takes it away again, so that what
    /// failed leaves nothing behind.
    void take_back() noexcept;

    /// How long the locks of others are waited for, ms.
    void wait_for_locks(int ms);
    /// Moves the log into the file and empties it, so that a copy of the file alone is whole. Waits
    /// for nobody: a reader that is still looking delays it to the next time. Then as
    /// require_in_place().
    void checkpoint();
    /// What is deleted is put back, as far as this connection sees it, and kept as FILE.rescued
    /// where another file has its name or its log was deleted.
    /// @throws StoreError if the file, or its log, was moved or deleted since it was opened: what
    /// is written goes with it, and another program does not see it
    void require_in_place();

    /// @throws StoreError "FILE: doing: what SQLite said"
    [[noreturn]] void fail(std::string_view doing) const { connection_.fail(doing); }
    /// For statements; the handle for what has no other way here.
    [[nodiscard]] const Connection& connection() const { return connection_; }
    [[nodiscard]] sqlite3* handle() const { return connection_.handle; }

private:
    void rescue_deleted();
    void require_log(Access access);
    void require_own_log();

    struct Identity {
        std::int64_t application = 0;
        std::int64_t version = 0;
        bool blank = false;  ///< a database without any table, nobody's yet
    };

    void open(Access access);
    void connect(const std::string& name, int flags);
    void check_identity(Access access);
    void check_schema(Access access);
    [[nodiscard]] Identity identity();
    void create();
    void keep_log();

    Connection connection_;
    int wait_ms_ = 5000;
    bool in_memory_ = false;
    bool made_ = false;      ///< the file, by this connection
    std::string rescued_{};  ///< where a deleted file's content is
    std::function<std::int64_t()> clock_;
};

/// All or nothing: rolls back unless commit() was reached.
class Transaction {
public:
    /// Begins at once, so that no other writer comes between. @throws StoreError if one holds the
    /// file
    explicit Transaction(Database& database);
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    ~Transaction();
    /// @throws StoreError; then it is rolled back
    void commit();

private:
    Database* database_;
};

/// Now by the clock of this machine, UTC, "2026-01-31T12:34:56.789Z".
[[nodiscard]] std::string utc_now();

/// One unchanging view of the database for several queries, also while a rig writes. Nests.
class Snapshot {
public:
    /// The view is that of the first query.
    explicit Snapshot(Database& database);
    Snapshot(const Snapshot&) = delete;
    Snapshot& operator=(const Snapshot&) = delete;
    ~Snapshot();

private:
    Database& database_;
};

}  // namespace palpate::data
