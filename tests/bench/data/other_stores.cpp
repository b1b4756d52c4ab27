#include <sqlite3.h>

#include "data/trace/columns.hpp"
#include "tests/bench/data/trace_store.hpp"
#include "tests/support/slurp.hpp"

namespace palpate::bench {
namespace {

using engine::TickRecord;

constexpr const char* kHead =
    "tick,time_ns,count_1,count_2,code_1,code_2,lateness_us,flags,mode,segment,u,hip_x_m,"
    "hip_y_m,cp_x_m,cp_y_m,go_x_m,go_y_m,fx_n,fy_n,command_x_n,command_y_n,fn_n,ft_n,mu\n";
constexpr int kX = 19;  // places in kHead
constexpr int kFn = 21;

class CsvStore : public TraceStore {
public:
    explicit CsvStore(std::string folder) : folder_(std::move(folder)) {}

    [[nodiscard]] std::string name() const override { return "CSV, a file a trial"; }

    void write(std::int64_t trial, std::span<const TickRecord> ticks) override {
        std::string text = kHead;
        auto out = std::back_inserter(text);
        for (const TickRecord& t : ticks) {
            fmt::format_to(
                out, "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                t.tick, t.time_ns, t.counts[0], t.counts[1], t.codes[0], t.codes[1], t.lateness_us,
                t.flags, static_cast<int>(t.mode), t.segment, t.u, t.hip.x, t.hip.y, t.cp.x, t.cp.y,
                t.go.x, t.go.y, t.force.x, t.force.y, t.command.x, t.command.y, t.normal_force,
                t.tangential_force, t.mu);
        }
        std::ofstream file(file_of(trial), std::ios::binary);
        if (!file.write(text.data(), static_cast<std::streamsize>(text.size())).flush()) {
            throw std::runtime_error("cannot write " + file_of(trial));
        }
        trials_ = trial;
    }
    void finish() override {}
    [[nodiscard]] std::uintmax_t bytes() const override {
        std::uintmax_t sum = 0;
        for (std::int64_t trial = 1; trial <= trials_; ++trial) {
            sum += std::filesystem::file_size(file_of(trial));
        }
        return sum;
    }
    [[nodiscard]] double mean_normal_force(std::int64_t trial) override {
        Sum sum;
        add(trial, kFn, sum);
        return sum.value / static_cast<double>(sum.n);
    }
    [[nodiscard]] double mean_command_x() override {
        Sum sum;
        for (std::int64_t trial = 1; trial <= trials_; ++trial) {
            add(trial, kX, sum);
        }
        return sum.value / static_cast<double>(sum.n);
    }

private:
    struct Sum {
        double value = 0.0;
        std::size_t n = 0;
    };
    [[nodiscard]] std::string file_of(std::int64_t trial) const {
        return fmt::format("{}/trial_{}.csv", folder_, trial);
    }
    void add(std::int64_t trial, int column, Sum& sum) const {
        const std::string text = tests::slurp(file_of(trial));
        const char* at = text.data() + text.find('\n') + 1;
        const char* end = text.data() + text.size();
        while (at < end) {
            for (int i = 0; i < column; ++i) {
                at = static_cast<const char*>(
                         std::memchr(at, ',', static_cast<std::size_t>(end - at))) +
                     1;
            }
            double value = 0.0;
            std::from_chars(at, end, value);
            sum.value += value;
            ++sum.n;
            at = static_cast<const char*>(
                     std::memchr(at, '\n', static_cast<std::size_t>(end - at))) +
                 1;
        }
    }

    std::string folder_;
    std::int64_t trials_ = 0;
};

}  // namespace

std::unique_ptr<TraceStore> csv_store(const std::string& folder) {
    return std::make_unique<CsvStore>(folder);
}

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
