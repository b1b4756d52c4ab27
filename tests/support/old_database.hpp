#pragma once

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"

/// Files as older programs wrote them.
namespace palpate::tests {

/// A file as palpate wrote it with schema `version`, with a session and a faulted trial in it.
inline void write_old(const std::string& file, int version) {
    std::ifstream in(
        fmt::format(PALPATE_SOURCE_DIR "/tests/golden/schema_{}.sql", std::max(version, 2)));
    std::string sql = "\n";  // or its first comment would look like an option
    sql.append(std::istreambuf_iterator<char>(in), {});
    if (version == 1) {
        sql +=
            "ALTER TABLE trial DROP COLUMN skipped_ticks;"
            "ALTER TABLE trial DROP COLUMN worst_episode_j;"
            "ALTER TABLE trial DROP COLUMN contact_episodes; PRAGMA user_version = 1;";
    }
    const std::string hash = "'" + std::string(64, 'a') + "'";
    sql +=
        "INSERT INTO study VALUES (1, 's', 't', " + hash +
        ", ''); INSERT INTO participant (id, code) VALUES (1, 'P1');"
        "INSERT INTO session (id, study, participant, number, kind, seed, plan_sha256, shuffles, "
        "device,"
        " rate_hz, stiffness_n_per_m, started_utc, finished) VALUES (1, 1, 1, 1, 'real', '7', " +
        hash +
        ", 1, 'd', 1000, 1000, '2026-01-31T12:34:56.789Z', 0);"
        "INSERT INTO plan (session, position, phase, object, curvature_per_m, friction, mu_s, mu_d,"
        " break_before) VALUES (1, 0, 'main', 'o', -2.5, 'f', 0.7, 0.5, 0);"
        "INSERT INTO trial (session, position, attempt, outcome, slip_decay, heal_decay, ticks,"
        " started_utc) VALUES (1, 0, 1, 'faulted', 0, 0, 5, '');";
    REQUIRE(Process({"sqlite3", file, sql}).wait().code == 0);
}

}  // namespace palpate::tests
