#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "data/store/database.hpp"

namespace palpate::data {

/// What a query may.
struct SqlLimits {
    bool attach = false;  ///< read other files too
    bool tells = false;   ///< after 10 s of the processor, to stderr, how to end it
    std::int64_t steps =
        2'000'000'000;  ///< of SQLite's machine, and us of processor time, a statement
};

/// While it lives, statements on a database read that file alone, by plain functions, make no value
/// of more than 50 MB, and end: somebody may have pasted them from anywhere. A single step that
/// goes on a second longer than all of them may ends the program, with exit code 1. One at a time.
class SqlGuard {
public:
    /// @param database  outlives this; nothing else may set its authorizer meanwhile
    SqlGuard(Database& database, SqlLimits limits);
    SqlGuard(const SqlGuard&) = delete;
    SqlGuard& operator=(const SqlGuard&) = delete;
    ~SqlGuard();

    /// Before each statement.
    void begin() noexcept;
    /// What is said of a statement that was refused.
    [[nodiscard]] std::string refusal(std::string_view statement) const;
    [[nodiscard]] const SqlLimits& limits() const noexcept { return limits_; }

private:
    static int count(void* guard) noexcept;
    static int authorize(void* guard,
                         int action,
                         const char* first,
                         const char* second,
                         const char* database,
                         const char* inner) noexcept;

    Database& database_;
    SqlLimits limits_;
    std::int64_t steps_left_ = 0;
    bool attached_ = false;  ///< another file was asked for
};

}  // namespace palpate::data
