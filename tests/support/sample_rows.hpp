#pragma once

#include "data/extension/sample_module.hpp"
#include "data/store/reader.hpp"
#include "data/trace/columns.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

/// Rows of the virtual table `sample`, and what they must be by the reader's ticks.
namespace palpate::tests {

using SampleRow = Words;

/// A value to the bit; NULL and NaN alike.
inline std::string exactly(double value) {
    return std::isnan(value) ? "null" : fmt::format("{:a}", value);
}

/// A value as the reader has it, as `sample` must give it.
template <class Value>
std::string cell(const Value& value) {
    if constexpr (std::is_floating_point_v<Value>) {
        return exactly(value);
    } else if constexpr (std::is_integral_v<Value>) {
        return std::to_string(value);
    } else {
        return value;
    }
}

/// Ten trials of the demo, recorded by the program.
inline const std::string& demo_file() {
    static const TemporaryFolder folder;
    static const std::string file = [] {
        ran({"demo", "--headless", "--db", folder.file("a.sqlite")});
        return folder.file("a.sqlite");
    }();
    return file;
}

struct Opened : data::Database {
    explicit Opened(const std::string& file, data::Access access = data::Access::read)
        : data::Database(file, access) {
        REQUIRE(data::add_extension(handle()) == 0);
    }
};

/// A copy of the demo's file, to be changed.
struct DemoCopy : private TemporaryFolder, Opened {
    DemoCopy()
        : Opened(copied(demo_file(), TemporaryFolder::file("d.sqlite")), data::Access::write) {}
};

inline std::vector<SampleRow> sql_rows(data::Database& database, const std::string& sql) {
    std::vector<SampleRow> rows;
    for (const data::Statement& row : database.prepare(sql)) {
        SampleRow& values = rows.emplace_back();
        for (int i = 0; i < row.columns(); ++i) {
            values.push_back(row.null(i)        ? "null"
                             : row.type(i) == 2 ? exactly(row.real(i))
                                                : row.text(i));
        }
    }
    return rows;
}

inline std::string plan_of(data::Database& database, const std::string& sql) {
    std::string text;
    for (const SampleRow& row : sql_rows(database, "EXPLAIN QUERY PLAN " + sql)) {
        text += row.back() + '\n';
    }
    return text;
}

inline std::string error_of(data::Database& database, const std::string& sql) {
    try {
        sql_rows(database, sql);
    } catch (const data::StoreError& e) {
        return e.what();
    }
    return {};
}

/// As if trial 3 of the demo had had a second interval, with the same ticks.
inline void add_interval(data::Database& database) {
    database.execute(
        "INSERT INTO trace_chunk SELECT trial_id, 2, first_tick, ticks, codec, period_ns, holds, "
        "crc32, derived, data FROM trace_chunk WHERE trial_id = 3;CREATE TEMP TABLE second AS "
        "SELECT * FROM presentation WHERE trial_id = 3;UPDATE second SET interval = 2; INSERT INTO "
        "presentation SELECT * FROM second;DROP TABLE second");
}

inline const Words& sample_columns() {
    static const Words names = split(
        "trial_id interval tick time_s count_1 count_2 code_1 code_2 lateness_us flags mode "
        "segment u hip_x_m hip_y_m cp_x_m cp_y_m go_x_m go_y_m rendered_x_n rendered_y_n "
        "commanded_x_n commanded_y_n rendered_normal_n rendered_tangential_n mu count_3 code_3 v "
        "hip_z_m cp_z_m go_z_m rendered_z_n commanded_z_n hip_vx_m_per_s hip_vy_m_per_s "
        "hip_vz_m_per_s",
        ' ');
    return names;
}

/// The first difference, by names. @param rows  of `sample`
inline void require_same(const std::vector<SampleRow>& rows,
                         const std::vector<SampleRow>& expected) {
    REQUIRE(rows.size() == expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (std::size_t c = 0; rows[i] != expected[i] && c < rows[i].size(); ++c) {
            CAPTURE(i, sample_columns()[c]);
            REQUIRE(rows[i][c] == expected[i][c]);
        }
    }
}

/// What `sample` must say of an interval of a trial.
inline std::vector<SampleRow> expected_rows(data::Database& database,
                                            std::int64_t trial,
                                            std::int64_t interval = 1) {
    std::vector<SampleRow> rows;
    const auto ticks = data::TraceReader(database).stored(trial, interval);
    const auto steps_of = [](double newton) {
        const auto steps = data::in_steps(newton, 1e4);
        return exactly(std::isfinite(newton) ? steps / 1e4 : std::nan(""));
    };
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const engine::TickRecord& t = ticks[i];
        engine::Vec3 v(std::nan(""));
        if (i > 0 && t.time_ns > ticks[i - 1].time_ns) {
            v = (t.hip - ticks[i - 1].hip) /
                (static_cast<double>(t.time_ns - ticks[i - 1].time_ns) * 1e-9);
        }
        const char* const modes[] = {"free", "stuck", "slip", "transition"};
        const auto row = [&](const auto&... values) {
            rows.push_back({cell(values)...});
        };
        row(trial, interval, t.tick, static_cast<double>(t.time_ns) / 1e9, t.counts[0], t.counts[1],
            t.codes[0], t.codes[1], static_cast<double>(t.lateness_us), t.flags,
            modes[static_cast<std::size_t>(t.mode)], t.segment, t.u, t.hip.x, t.hip.y, t.cp.x,
            t.cp.y, t.go.x, t.go.y, t.force.x, t.force.y, steps_of(t.command.x),
            steps_of(t.command.y), t.normal_force, t.tangential_force, t.mu, t.counts[2],
            t.codes[2], t.v, t.hip.z, t.cp.z, t.go.z, t.force.z, steps_of(t.command.z), v.x, v.y,
            v.z);
    }
    return rows;
}

}  // namespace palpate::tests
