#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "data/sql/statement.hpp"

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

}  // namespace palpate::data
