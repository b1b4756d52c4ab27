#include "data/trace/sample_columns.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "data/trace/columns.hpp"

namespace palpate::data {

constexpr std::string_view kSaid = R"(CREATE TABLE sample (
    -- Every servo tick of every trial, ordered by trial_id, interval and tick. Frame: the object's. What
    -- follows from the hand's path is computed again by the trial's own scene, and refused if it is not
    -- what was recorded. Ask for the trials and the columns needed only (trial_id = 7, BETWEEN, IN, a join).
    -- The ticks after done, while the force goes out, are here too: trial and presentation count those with
    -- tick < presentation.ticks. Commanded forces are in whole steps of 100 uN, as chunks hold them.
    trial_id INTEGER,  -- trial.trial_id
    interval INTEGER,  -- 1; 2: the second of a trial with two
)";

std::string sample_declaration() {
    std::string sql(kSaid);
    for (const TraceColumn& column : trace_columns()) {
        std::string type(column.type);
        std::ranges::transform(type, type.begin(), [](char c) { return c - 'a' + 'A'; });
        sql += fmt::format("    {} {},  -- {}\n", column.name, type, column.meaning);
    }
    return sql +
           "    hip_vx_m_per_s REAL,  -- of HIP: (x - x of the stored tick before) / (t - t of "
           "it); NULL: no tick "
           "before\n"
           "    hip_vy_m_per_s REAL,  -- the same in y\n"
           "    hip_vz_m_per_s REAL  -- the same in z\n)";
}

}  // namespace palpate::data
