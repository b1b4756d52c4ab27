#include <algorithm>
#include <array>
#include <csignal>
#include <limits>

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/time.h>
#include <unistd.h>

#include "engine/base/text.hpp"
#include "data/shell/sql_shell.hpp"

namespace palpate::data {
namespace {

constexpr int kStepsAtOnce = 100'000;
constexpr int kLongestValue = 50'000'000;  // bytes; the longest that palpate stores has 0.1 MB

/// bytes; what does not find room is refused, and goes to no disk
constexpr std::int64_t kMaxMemory = std::int64_t{1} << 30U;

/// A function of SQLite's own cannot be ended: instr of 1 MB takes 5 s, LIKE of 0.25 MB 18 s.
/// SIGPROF comes after ten seconds, to say so, and each second from then on. When the statement's
/// time is over SQLite ends it when it next looks; and a second later, when one step goes on for
/// ever, the program ends.
volatile std::sig_atomic_t time_is_over = 0;
volatile std::sig_atomic_t seconds_left = 0;  ///< when SIGPROF comes
volatile std::sig_atomic_t at_it_said = 0;
constexpr std::int64_t kSaidAfter = 10'000'000;  // us of the processor

void to_stderr(std::string_view text) {
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
}

void on_time(int /*signal*/) {
    if (time_is_over == 0 && seconds_left > 0) {
        seconds_left = seconds_left - 1;
        if (at_it_said == 0) {
            at_it_said = 1;
            to_stderr(
                "palpate: still at it; Ctrl-C ends it, and --steps says when it ends by itself\n");
        }
        return;
    }
    if (time_is_over != 0) {
        to_stderr(
            "palpate: one step of this takes longer than a statement may, --steps gives it more; "
            "of rows before it the last may be missing\n");
        _exit(1);
    }
    time_is_over = 1;
}

/// @param us  of the processor, from now on; 0: as much as it takes
void limit_time(std::int64_t us, bool tells = false) {
    const std::int64_t first = std::min(us, kSaidAfter);
    const std::int64_t more = us - first + 999'999;
    time_is_over = 0;
    at_it_said = tells ? 0 : 1;
    seconds_left = static_cast<std::sig_atomic_t>(
        std::min<std::int64_t>(more / 1'000'000, std::numeric_limits<std::sig_atomic_t>::max()));
    std::signal(SIGPROF, on_time);
    const itimerval limit{
        .it_interval = {.tv_sec = us == 0 ? 0 : 1, .tv_usec = 0},
        .it_value = {.tv_sec = first / 1'000'000, .tv_usec = first % 1'000'000},
    };
    setitimer(ITIMER_PROF, &limit, nullptr);
}

/// Pragmas that only say something; others change the connection, the file or other files.
bool only_says(std::string_view pragma, bool with_value) {
    constexpr std::array<std::string_view, 16> kSay{
        "collation_list",    "compile_options",  "database_list",   "encoding",
        "foreign_key_check", "foreign_key_list", "function_list",   "index_info",
        "index_list",        "index_xinfo",      "integrity_check", "page_count",
        "quick_check",       "table_info",       "table_list",      "table_xinfo"};
    return std::ranges::find(kSay, pragma) != kSay.end() ||
           (!with_value && (pragma == "user_version" || pragma == "application_id"));
}

/// SQLite's printf, in a database of its own. Of a text that is longer than a value may be it makes
/// NULL without a word; behind an x nothing else is NULL.
struct Printf {
    static constexpr int kArguments = 127;  // SQLite's own limit
    sqlite3* own = nullptr;
    sqlite3_stmt* select = nullptr;

    Printf() {
        std::string sql = "SELECT printf('x' || ?1";
        for (int i = 2; i <= kArguments; ++i) {
            sql += fmt::format(", ?{}", i);
        }
        if (sqlite3_open(":memory:", &own) == SQLITE_OK) {
            sqlite3_limit(own, SQLITE_LIMIT_LENGTH, kLongestValue);
            sqlite3_prepare_v2(own, (sql + ')').c_str(), -1, &select, nullptr);
        }
    }
    Printf(const Printf&) = delete;
    Printf& operator=(const Printf&) = delete;
    ~Printf() {
        sqlite3_finalize(select);
        sqlite3_close(own);
    }

    static void call(sqlite3_context* context, int count, sqlite3_value** values) noexcept {
        sqlite3_stmt* row = static_cast<Printf*>(sqlite3_user_data(context))->select;
        if (count == 0 || sqlite3_value_bytes(values[0]) == 0) {
            return;  // NULL
        }
        int code = SQLITE_OK;
        for (int i = 0; i < count && code == SQLITE_OK; ++i) {
            code = sqlite3_bind_value(row, i + 1, values[i]);
        }
        code = code == SQLITE_OK ? sqlite3_step(row) : code;
        if (code != SQLITE_ROW) {
            sqlite3_result_error_code(context, code);
        } else if (sqlite3_column_type(row, 0) == SQLITE_NULL) {
            sqlite3_result_error_toobig(context);
        } else {
            const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, 0));
            sqlite3_result_text(context, text + 1, sqlite3_column_bytes(row, 0) - 1,
                                SQLITE_TRANSIENT);
        }
        sqlite3_reset(row);
        sqlite3_clear_bindings(row);
    }
};

}  // namespace

SqlGuard::SqlGuard(Database& database, SqlLimits limits) : database_(database), limits_(limits) {
    sqlite3_hard_heap_limit64(kMaxMemory);
    sqlite3_limit(database.handle(), SQLITE_LIMIT_LENGTH, kLongestValue);
    for (const char* name : {"printf", "format"}) {
        sqlite3_create_function_v2(database.handle(), name, -1,
                                   SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS,
                                   new Printf, Printf::call, nullptr, nullptr,
                                   [](void* one) { delete static_cast<Printf*>(one); });
    }
    sqlite3_progress_handler(database.handle(), kStepsAtOnce, count, this);
    sqlite3_set_authorizer(database.handle(), authorize, this);
}

SqlGuard::~SqlGuard() {
    sqlite3_progress_handler(database_.handle(), 0, nullptr, nullptr);
    sqlite3_set_authorizer(database_.handle(), nullptr, nullptr);
    sqlite3_hard_heap_limit64(0);
    limit_time(0);
}

void SqlGuard::begin() noexcept {
    steps_left_ = limits_.steps;
    attached_ = false;
    // A step takes 0.02 to 0.1 us.
    limit_time(std::max(limits_.steps, std::int64_t{1'000}), limits_.tells);
}

int SqlGuard::count(void* guard) noexcept {
    const bool ends = (static_cast<SqlGuard*>(guard)->steps_left_ -= kStepsAtOnce) < 0;
    return ends || time_is_over != 0 ? 1 : 0;
}

int SqlGuard::authorize(void* guard,
                        int action,
                        const char* first,
                        const char* second,
                        const char* /*database*/,
                        const char* /*inner*/) noexcept {
    auto& own = *static_cast<SqlGuard*>(guard);
    switch (action) {
        case SQLITE_SELECT:
        case SQLITE_READ:
        case SQLITE_RECURSIVE:
        case SQLITE_TRANSACTION:
        case SQLITE_SAVEPOINT:
            return SQLITE_OK;
        case SQLITE_FUNCTION: {
            const std::string_view name = second;
            return name == "load_extension" || name == "fts3_tokenizer" ? SQLITE_DENY : SQLITE_OK;
        }
        case SQLITE_PRAGMA:
            return only_says(first, second != nullptr) ? SQLITE_OK : SQLITE_DENY;
        case SQLITE_ATTACH:
        case SQLITE_DETACH:
            own.attached_ = true;
            return own.limits_.attach ? SQLITE_OK : SQLITE_DENY;
        case SQLITE_UPDATE:  // how SQLite declares a virtual table; it refuses others itself
            return std::string_view(first) == "sqlite_master" ? SQLITE_OK : SQLITE_DENY;
        default:
            return SQLITE_DENY;
    }
}

std::string SqlGuard::refusal(std::string_view statement) const {
    return fmt::format(
        "palpate: palpate sql only reads this file, and this would do more: {}\n  {}\n",
        plain(statement.substr(0, 60)),
        attached_ && !limits_.attach ? "--attach lets it read other files too."
                                     : "To change something take a copy of the file and sqlite3.");
}

}  // namespace palpate::data
