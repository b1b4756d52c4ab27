#include "data/trace/sample_columns.hpp"

namespace palpate::data {

std::string_view sample_declaration() noexcept {
    return R"sql(CREATE TABLE sample (
    -- Every servo tick of every trial, ordered by trial_id, interval and tick. Frame: the object's. What
    -- follows from the hand's path is computed again by the trial's own scene, and refused if it is not
    -- what was recorded. Ask for the trials and the columns needed only (trial_id = 7, BETWEEN, IN, a join).
    -- The ticks after done, while the force goes out, are here too: trial_summary, trial and presentation count
    -- those with tick < presentation.ticks.
    trial_id     INTEGER,  -- trial.id
    interval     INTEGER,  -- 1; 2: the second of a trial with two
    tick         INTEGER,  -- number of the tick in its interval, from 0; from presentation.ticks on: after done
    t_s          REAL,     -- since the interval's first deadline, on the servo's clock
    x_m          REAL,     -- haptic interaction point (HIP): where the handle is
    y_m          REAL,     -- its y
    vx_m_per_s   REAL,     -- of HIP: (x - x of the stored tick before) / (t - t of it); NULL: no tick before
    vy_m_per_s   REAL,     -- the same in y
    cp_x_m       REAL,     -- closest point of the outline; the last one found where flags has 16
    cp_y_m       REAL,     -- its y
    go_x_m       REAL,     -- god-object
    go_y_m       REAL,     -- its y
    mode         TEXT,     -- free, stuck, slip, transition
    segment      INTEGER,  -- under the god-object: from 0 in the direction of travel; -1 - j: on vertex j
    u            REAL,     -- of the god-object on its segment, 0 to 1; on a vertex its angle, rad
    mu           REAL,     -- friction coefficient in force
    fn_n         REAL,     -- rendered force along the outward normal at the god-object
    ft_n         REAL,     -- rendered force along the direction of travel
    rendered_x_n REAL,     -- rendered force on the hand, K (GO - HIP) and damping; less where flags has 32
    rendered_y_n REAL,     -- its y
    fx_n         REAL,     -- commanded force: asked of the device, after the safety chain
    fy_n         REAL,     -- its y
    lateness_us  REAL,     -- wake-up minus deadline
    flags        INTEGER,  -- 1 saturated, 2 late, 4 ramped, 8 fault, 16 skipped, 32 held (force cut), 64 slewed, 128 stale
    count_1      INTEGER,  -- encoder 1 as read
    count_2      INTEGER,  -- encoder 2 as read
    code_1       INTEGER,  -- as written to motor 1
    code_2       INTEGER   -- as written to motor 2
))sql";
}

}  // namespace palpate::data
