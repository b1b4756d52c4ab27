#include <sqlite3.h>

#include "protocols/session/trial_meter.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/own_schema.hpp"
#include "data/trace/columns.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

TEST_CASE("every column of every table and view has a meaning, and every physical one a unit") {
    NewDatabase database;
    const auto manual = data::schema_manual(data::schema_sql());
    // What has no unit though it is REAL.
    const std::set<std::string> plain{"mu_s", "mu_d", "mu_s_1", "mu_s_2", "comparison_mu_s",
                                      "slip_decay", "heal_decay", "u", "v", "mu", "scale",
                                      "covered_share",
                                      // In the unit of what the rule varies, on its scale.
                                      "stimulus", "estimate"};
    std::size_t columns = 0;
    for (const data::Statement& row :
         database.prepare("SELECT s.name, c.name, c.type FROM sqlite_schema AS s, "
                          "pragma_table_info(s.name) AS c WHERE s.type IN ('table', 'view')")) {
        ++columns;
        CAPTURE(row.text(0), row.text(1));
        const auto table = std::ranges::find(manual, row.text(0), &data::TableManual::name);
        REQUIRE(table != manual.end());
        CHECK_FALSE(table->meaning.empty());
        const auto column =
            std::ranges::find(table->columns, row.text(1), &data::ColumnManual::name);
        REQUIRE(column != table->columns.end());
        CHECK_FALSE(column->meaning.empty());
        CHECK((row.text(2) != "REAL" || column->unit != "-" || plain.contains(row.text(1))));
    }
    CHECK(columns > 200);
    std::size_t read = 0;
    for (const auto& table : manual) {
        read += table.columns.size();
    }
    CHECK(read == columns);  // and the manual makes none up
}

TEST_CASE(
    "every measure of a trial is a column with its words where its places say, and only there") {
    std::size_t generated = 0;
    for (const protocols::Measure& one : protocols::measures()) {
        CAPTURE(std::string(one.column));
        bool kept = false;
        for (const auto& [table, place] :
             {std::pair("trial.", one.in_trial), std::pair("presentation.", one.in_interval)}) {
            const auto* column = data::find_column(table + std::string(one.column));
            kept = kept || column != nullptr;
            if (place > 0) {
                ++generated;
                REQUIRE(column != nullptr);  // no other measure has its place
                CHECK(column->meaning == one.meaning);
                CHECK(column->type ==
                      (std::holds_alternative<double>(one.value({})) ? "REAL" : "INTEGER"));
                CHECK(column->nullable);
            } else {
                CHECK((column == nullptr || one.meaning.empty()));
            }
        }
        CHECK(kept);
    }
    CHECK(generated > 40);
}

TEST_CASE("what a file of this palpate holds is known without making one, to the letter") {
    const auto differences = [](const char* sql) {
        data::Connection file{.file = "memory"};
        sqlite3_open(":memory:", &file.handle);
        file.execute(sql);
        const std::size_t found = data::schema_differences(file).size();
        std::size_t held = 0;
        {
            data::Statement row(file, "SELECT count(*) FROM sqlite_master");
            row.step();
            held = static_cast<std::size_t>(row.integer(0));
        }
        file.forget_idle();
        sqlite3_close(file.handle);
        return std::pair(found, held);
    };
    const std::string made(data::schema_sql());
    const auto [changed, held] = differences(made.c_str());
    CHECK(changed == 0);  // no statement, and no index of a key, is another than SQLite's
    CHECK(held > 30);
    CHECK(differences("SELECT 1").first == held);  // and none is missing
}

TEST_CASE("every column of sample has a meaning, in the order of the program") {
    const auto manual = data::schema_manual(data::sample_declaration());
    REQUIRE(manual.size() == 1);
    const auto ticks = data::trace_columns();
    REQUIRE(manual[0].columns.size() == 2 + ticks.size() + 3);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        CHECK(manual[0].columns[2 + i].name == ticks[i].name);
    }
    CHECK(manual[0].columns.back().name == "hip_vz_m_per_s");
    for (const auto& column : manual[0].columns) {
        CAPTURE(column.name);
        CHECK_FALSE(column.meaning.empty());
    }
}

TEST_CASE("the manual reads comments, literals and expressions of any statement") {
    const auto manual = data::schema_manual(
        "-- CREATE TABLE not (a);\nCREATE TABLE t (\n  -- of the table\n  a_m REAL CHECK (a_m IN "
        "('x,y', '--')), -- first\n  b TEXT -- second,\n    NOT NULL, -- goes on\n  UNIQUE (a_m, "
        "b)\n) STRICT;\n"
        "CREATE VIEW v AS\n-- of the view\nSELECT t.b, -- plain\n (SELECT max(x, 1) FROM u) AS m_s "
        "-- named\nFROM t;");
    REQUIRE(manual.size() == 2);
    CHECK(manual[0].meaning == "of the table");
    REQUIRE(manual[0].columns.size() == 2);
    CHECK(manual[0].columns[0].unit == "m");
    CHECK(manual[0].columns[0].meaning == "first");
    CHECK(manual[0].columns[1].meaning == "second, goes on");
    CHECK(manual[1].meaning == "of the view");
    REQUIRE(manual[1].columns.size() == 2);
    CHECK(manual[1].columns[0].name == "b");
    CHECK(manual[1].columns[1].name == "m_s");
    CHECK(manual[1].columns[1].unit == "s");
    CHECK(manual[1].columns[1].meaning == "named");
}

TEST_CASE(
    "the catalogue says of each column its type, whether it may be nothing, its words and who sees "
    "it") {
    const auto& kind = *data::find_column("session.session_kind");
    CHECK(kind.type == "TEXT");
    CHECK_FALSE(kind.nullable);
    CHECK(kind.meaning == "what the session is");
    CHECK(
        kind.levels ==
        "real = a session of the study; pilot = to try it; simulated = computed hand and answers");
    CHECK(kind.seen == data::Visibility::everybody);
    CHECK(data::find_column("session.operator")->seen == data::Visibility::details);
    CHECK(data::find_column("session.operator")->nullable);
    CHECK(data::find_column("participant.participant_code")->seen == data::Visibility::file);
    // A view repeats it, with all that is said of it.
    const auto& shown = *data::find_column("analysis_trial.session_kind");
    CHECK(shown.source == "session.session_kind");
    CHECK(shown.meaning == kind.meaning);
    CHECK(shown.levels == kind.levels);
    CHECK(data::find_column("analysis_trial.slip_share")->source.empty());
    CHECK(data::find_column("trial.nothing") == nullptr);
    CHECK(data::find_column("nothing") == nullptr);
}
