#include <sqlite3.h>

#include "data/trace/columns.hpp"
#include "tests/bench/data/trace_store.hpp"

namespace palpate::bench {
namespace {

class RowStore : public TraceStore {
public:
    explicit RowStore(const std::string& folder) : file_(folder + "/rows.sqlite") {
        require(sqlite3_open(file_.c_str(), &database_));
        execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
        std::string columns;
        std::string places = "?1";
        int place = 1;
        for (const data::TraceColumn& column : data::trace_columns()) {
            const bool real = column.memory.starts_with('f');
            columns += fmt::format(", {} {}", column.name, real ? "REAL" : "INTEGER");
            places += fmt::format(", ?{}", ++place);
        }
        execute(fmt::format("CREATE TABLE sample (trial INTEGER NOT NULL{},"
                            " PRIMARY KEY (trial, tick)) WITHOUT ROWID",
                            columns)
                    .c_str());
        insert_ = prepare(fmt::format("INSERT INTO sample VALUES ({})", places));
    }
    ~RowStore() override {
        sqlite3_finalize(insert_);
        sqlite3_close_v2(database_);
    }

    [[nodiscard]] std::string name() const override { return "SQLite, a row a sample"; }

    void write(std::int64_t trial, std::span<const engine::TickRecord> ticks) override {
        execute("BEGIN");
        for (const engine::TickRecord& tick : ticks) {
            sqlite3_bind_int64(insert_, 1, trial);
            bind(tick);
            if (sqlite3_step(insert_) != SQLITE_DONE) {
                throw std::runtime_error(sqlite3_errmsg(database_));
            }
            sqlite3_reset(insert_);
        }
        execute("COMMIT");
    }

    void finish() override { execute("PRAGMA wal_checkpoint(TRUNCATE)"); }
    [[nodiscard]] std::uintmax_t bytes() const override {
        return std::filesystem::file_size(file_);
    }
    [[nodiscard]] double mean_normal_force(std::int64_t trial) override {
        return value(
            fmt::format("SELECT avg(rendered_normal_n) FROM sample WHERE trial = {}", trial));
    }
    [[nodiscard]] double mean_command_x() override {
        return value("SELECT avg(commanded_x_n) FROM sample");
    }

private:
    void require(int code) const {
        if (code != SQLITE_OK) {
            throw std::runtime_error(sqlite3_errmsg(database_));
        }
    }
    void execute(const char* sql) {
        require(sqlite3_exec(database_, sql, nullptr, nullptr, nullptr));
    }
    [[nodiscard]] sqlite3_stmt* prepare(const std::string& sql) const {
        sqlite3_stmt* statement = nullptr;
        require(sqlite3_prepare_v2(database_, sql.c_str(), -1, &statement, nullptr));
        return statement;
    }
    [[nodiscard]] double value(const std::string& sql) const {
        sqlite3_stmt* statement = prepare(sql);
        sqlite3_step(statement);
        const double result = sqlite3_column_double(statement, 0);
        sqlite3_finalize(statement);
        return result;
    }
    void bind(const engine::TickRecord& tick) {
        int place = 1;
        for (const data::TraceColumn& column : data::trace_columns()) {
            const auto* at = reinterpret_cast<const std::byte*>(&tick) + column.offset;
            ++place;
            if (column.memory == "f64le") {
                sqlite3_bind_double(insert_, place, *reinterpret_cast<const double*>(at));
            } else if (column.memory == "f32le") {
                sqlite3_bind_double(insert_, place, *reinterpret_cast<const float*>(at));
            } else if (column.memory == "i64le") {
                sqlite3_bind_int64(insert_, place, *reinterpret_cast<const std::int64_t*>(at));
            } else if (column.memory == "i32le") {
                sqlite3_bind_int64(insert_, place, *reinterpret_cast<const std::int32_t*>(at));
            } else if (column.memory == "i16le") {
                sqlite3_bind_int64(insert_, place, *reinterpret_cast<const std::int16_t*>(at));
            } else {
                sqlite3_bind_int64(insert_, place, *reinterpret_cast<const std::uint8_t*>(at));
            }
        }
    }

    std::string file_;
    sqlite3* database_ = nullptr;
    sqlite3_stmt* insert_ = nullptr;
};

}  // namespace

std::unique_ptr<TraceStore> row_store(const std::string& folder) {
    return std::make_unique<RowStore>(folder);
}

}  // namespace palpate::bench
