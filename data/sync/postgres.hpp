#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "data/sql/statement.hpp"
#include "data/store/database.hpp"
#include "data/sync/session_version.hpp"

namespace palpate::data {

/// The server, or the way to it, failed. Never says a password.
class PostgresError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A row's values, which the server takes as text, reals to the bit, or as bytes.
using PostgresRow = std::vector<ColumnValue>;

/// A connection to a PostgreSQL server by libpq, the only place that knows it.
class Postgres {
public:
    /// @param url  postgresql://...; TLS and all else as libpq's documentation of connection URIs
    /// says
    /// @param insecure  beyond this machine also without sslmode=verify-full, where others can read
    ///                  what is sent or answer in the server's place
    /// @throws std::invalid_argument if it is no such URL, it is not secure, or libpq is not
    /// installed
    /// @throws PostgresError if nobody answers there
    explicit Postgres(const std::string& url, bool insecure = false);

    /// "127.0.0.1, over TLSv1.3, the server not checked"
    [[nodiscard]] std::string way() const;

    /// Several statements, all or nothing. @throws PostgresError
    void run(const std::string& sql);
    /// All rows as text; NULL is nothing.
    [[nodiscard]] std::vector<std::vector<std::optional<std::string>>> rows(
        const std::string& sql, const PostgresRow& parameters = {});

    /// Notes a statement for flush(): sent at once in pipeline mode, without waiting for its
    /// answer.
    void send(const std::string& sql, const PostgresRow& parameters);
    /// Waits for all answers: what was sent since the last flush is one transaction.
    /// @return rows that were added @throws PostgresError if any failed: then none was added
    std::int64_t flush();

private:
    [[noreturn]] void fail(std::string_view doing, const char* words) const;

    struct Finish {
        void operator()(void* connection) const;
    };
    std::unique_ptr<void, Finish> connection_;
    std::size_t waiting_ = 0;
};

/// A table on the server. All rows but those of studies, people and trace_column begin with their
/// session's uuid, in the primary key too: so they can be partitioned or spread by session, and
/// nothing refers across. Rows are only added, never changed: what changes in a file (a session
/// ends, an answer no longer counts) is a row of its own here.
struct PostgresTable {
    std::string name;
    std::vector<std::pair<std::string, std::string>> columns;  ///< name, PostgreSQL's type
    std::vector<std::string> key;
};

/// catalogue_layout() without the secrets of sessions: who has one can compute whose an order is.
[[nodiscard]] Layout pushed_layout();

/// study, participant_note, session, session_end, trial, trial_invalid, event, and every table of
/// the catalogue that belongs to a session or a trial, with the same columns; trial counts a
/// session's attempts from 1. participant_detail stays in the lab.
/// @param layout  pushed_layout()
[[nodiscard]] std::vector<PostgresTable> postgres_tables(const Layout& layout);

/// SQL that makes the schema `palpate` with these tables where they are not there. Chunks are
/// not compressed again (STORAGE EXTERNAL).
[[nodiscard]] std::string postgres_schema(const std::vector<PostgresTable>& tables);

/// Makes what postgres_schema() makes, if it is not there and the user may.
/// @throws PostgresError where the user may not, or a table is there without one of its columns
void require_schema(Postgres& server, const std::vector<PostgresTable>& tables);

/// SQL for an administrator: roles palpate_writer (adds and reads rows) and palpate_reader (reads),
/// to be granted to people and programs.
[[nodiscard]] std::string postgres_roles();

/// Statements of a row with all columns, parameters $1 and on.
struct PostgresRows {
    std::string insert;  ///< nothing happens if its key is there
    std::string same;    ///< a row if it is there with these values, none of which is NULL
};
[[nodiscard]] PostgresRows postgres_rows(const PostgresTable& table);

/// Who does not consent by a server's notes, and which sessions are theirs: an older copy of a file
/// can have one as another's. Of whom something was destroyed, too.
class Refusals {
public:
    /// @throws PostgresError
    void read(Postgres& server);
    /// Somebody of this code refused.
    [[nodiscard]] bool hold(const std::string& code) const { return codes_.contains(code); }
    /// The session is of who refused, and no note in its file since then says that it is another's.
    [[nodiscard]] bool hold(const SessionVersion& session) const;
    /// When something of theirs was last destroyed in a file that was pushed; "": never.
    [[nodiscard]] std::string destroyed(const std::string& code) const {
        const auto there = destroyed_.find(code);
        return there == destroyed_.end() ? "" : there->second;
    }
    /// A row of participant_note: the session is theirs, who do not consent.
    [[nodiscard]] static PostgresRow note(const SessionVersion& session);

private:
    std::set<std::string> codes_;
    std::map<std::string, std::string> destroyed_;  ///< by code
    std::map<std::string, std::int64_t> moves_;     ///< by uuid: how often it had become another's
};

/// Before rows that several files have: two rigs that add them in other orders would wait for each
/// other.
inline constexpr std::string_view kOneAtATime = "SELECT pg_advisory_xact_lock(1885432945)";

/// A row of a file, behind what the server's table has before it.
[[nodiscard]] PostgresRow with_row(PostgresRow before, const Statement& row);

/// Adds what is of no session: studies that are what their text says (of another no session is
/// whole), and trace_column.
/// @param sql  of each table
/// @param conflicts  gets what the server has otherwise @return rows that were added
[[nodiscard]] std::int64_t push_shared(Database& database,
                                       Postgres& server,
                                       const std::map<std::string, PostgresRows>& sql,
                                       std::vector<std::string>& conflicts);

}  // namespace palpate::data
