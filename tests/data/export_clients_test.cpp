#include "data/export/csv_export.hpp"
#include "data/export/duckdb.hpp"
#include "data/store/database.hpp"
#include "tests/support/child.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

using namespace palpate::data;
namespace fs = std::filesystem;

namespace {

/// Two studies, one whose rule chooses, with three people: words that tables find hard, confidence,
/// a mark, a session that was killed and resumed, one that is not finished.
struct AwkwardLab {
    AwkwardLab() {
        std::string shapes =
            edited(slurp(PALPATE_SOURCE_DIR "/protocols/library/shape_friction_demo.toml"),
                   {{"\"shape_friction_demo\"", "\"sekil_1\""},
                    {"\"Felt shape", "\"Şekil: \\\"dış bükey\\\" mi, çukur mu"},
                    {"[timing]", "[response]\nconfidence = true\n[timing]"}});
        const std::size_t other = shapes.find("[[object]]\nname = \"concave_5\"");
        shapes.erase(other, shapes.find("[[object]]\nname = \"convex_10\"") - other);
        const std::string first = write(folder.file("shapes.toml"), shapes);
        const std::string second = write(
            folder.file("chosen.toml"),
            edited(
                slurp(PALPATE_SOURCE_DIR "/protocols/library/curvature_2afc.toml"),
                {{"trials = 60", "trials = 2"}, {"practice_trials = 4", "practice_trials = 1"}}));
        run(first, "P01");
        run(second, "P01");
        run(first, "Ayse_02");
        Process cut({palpate_program(), "run", first, "--participant", "P03", "--db", file,
                     "--device", "sim", "--headless", "--speed", "1"});
        REQUIRE(eventually([&] { return running(); }));
        std::this_thread::sleep_for(std::chrono::milliseconds(400));  // some ticks of it
        cut.signal(SIGKILL);
        (void)cut.wait();
        REQUIRE(running());
        ran({"participant", file, "P01", "--handedness", "80", "--set",
             "hobi=sağ el, \"ağrı\"; 'x'"});
        ran({"note", file, "satır bir\nsatır iki,\t\"tırnak\"; çğıöşü", "--participant",
             "Ayse_02"});
        ran({"mark", file, "3", "--invalid", "zil\n\"çaldı\", bell\trang"});
    }

    void run(const std::string& protocol, const std::string& who) {
        ran(run_words(protocol, who, file, {"--device", "sim", "--headless", "--speed", "0"}));
    }

    [[nodiscard]] bool running() const {
        return sql_now(file, "SELECT count(*) FROM trial WHERE outcome = 'running'") == "1";
    }

    /// @return the folder
    fs::path exported(const std::string& format, const Words& words) {
        const fs::path out = folder.path() / format;
        const Words command = joined(
            {"export", file, "--format", format, "--kind", "all", "-o", out.string()}, words);
        ran(command);
        return out;
    }

    TemporaryFolder folder;
    std::string file = folder.file("study.sqlite");
};

/// What recount.py prints, by SQL from the file itself.
std::string recounted(const std::string& file) {
    Database database(file, Access::read);
    std::string all;
    for (const char* format : {"csv", "bids", "psych-ds"}) {
        auto row = database.prepare(
            "SELECT plan.planned_object, friction, count(*), total(correct), max(reaction_s) FROM "
            "trial JOIN plan USING (session_id, plan_position) JOIN response USING (trial_id) "
            "WHERE invalid_reason IS NULL GROUP BY 1, 2 ORDER BY 1, 2");
        while (row.step()) {
            all += fmt::format("{} {} {} {} {:.0f} {:.17g}\n", format, row.text(0), row.text(1),
                               row.integer(2), row.real(3), row.real(4));
        }
    }
    auto chosen = database.prepare(
        "SELECT run_name, comparison_interval, stimulus FROM trial JOIN adaptive_plan USING "
        "(session_id, plan_position) JOIN presentation ON presentation.trial_id = trial.trial_id "
        "AND interval = comparison_interval ORDER BY trial.trial_id");
    while (chosen.step()) {
        all += fmt::format("{} {} {:.17g}\n", chosen.text(0), chosen.integer(1), chosen.real(2));
    }
    for (const auto& note :
         database.prepare("SELECT lower(hex(text)) FROM event WHERE event_kind = 'note'")) {
        all += "note " + note.text(0) + '\n';
    }
    return all;
}

}  // namespace

TEST_CASE("Python and R count the same answers in CSV, BIDS and Psych-DS as the file has") {
    AwkwardLab lab;
    for (const char* format : {"csv", "bids", "psych-ds"}) {
        lab.exported(format, {"--with-details"});
    }
    const std::string expected = recounted(lab.file);
    const std::string folder = lab.folder.path().string();
    const std::string scripts = PALPATE_SOURCE_DIR "/tests/data/clients/";
    CHECK(ended(Process({"python3", scripts + "recount.py", folder}).wait()).out == expected);
    if (has_r()) {
        CHECK(ended(Process({"Rscript", "--vanilla", scripts + "recount.R", folder}).wait()).out ==
              expected);
    }
}

TEST_CASE("bids-validator finds no error in an export") {
    const char* validator = std::getenv("PALPATE_BIDS_VALIDATOR");
    if (validator == nullptr || *validator == '\0') {
        WARN(
            "skipped: PALPATE_BIDS_VALIDATOR is not set (npm install bids-validator; then its path "
            "node_modules/.bin/bids-validator)");
        return;
    }
    AwkwardLab lab;
    const fs::path out = lab.exported("bids", {"--traces", "--keep-codes"});
    const Finished done = Process({validator, out.string(), "--json"}).wait();
    CAPTURE(done.out.substr(0, 2000), done.error);
    CHECK(done.code == 0);
    CHECK_THAT(done.out, Has("\"errors\":[]"));
    const std::string warned = done.out.substr(0, done.out.find("\"ignored\":"));
    // 38: not everybody did everything. 82: motion.tsv has no head line, as the standard has it.
    // 113: no authors.
    for (std::size_t at = 0; (at = warned.find("\"code\":", at)) != std::string::npos; ++at) {
        const int code = std::atoi(warned.c_str() + at + 7);
        CHECK((code == 38 || code == 82 || code == 113));
    }
}

TEST_CASE("DuckDB reads from Parquet what stands in the CSV files, column by column") {
    const char* library = std::getenv("PALPATE_DUCKDB");
    if (library == nullptr || *library == '\0') {
        WARN(
            "skipped: PALPATE_DUCKDB is not set (npm install @duckdb/node-bindings-linux-x64; then "
            "the path of its libduckdb.so)");
        return;
    }
    AwkwardLab lab;
    const fs::path csv = lab.exported("csv", {"--traces", "--with-details"});
    const fs::path parquet = lab.exported("parquet", {"--traces", "--with-details"});
    data::DuckDb duck;
    const auto compare = [&duck](const std::string& name, const std::string& from,
                                 const std::string& to) {
        CAPTURE(name);
        // Text, as it stands; a quoted empty field is a text, another one is nothing.
        duck.run(
            fmt::format("CREATE OR REPLACE TABLE text AS SELECT row_number() OVER () AS row_, * "
                        "FROM read_csv('{}', header = true, all_varchar = true, delim = ',', quote "
                        "= '\"', escape = '\"', allow_quoted_nulls = false)",
                        from));
        duck.run(
            fmt::format("CREATE OR REPLACE TABLE typed AS SELECT row_number() OVER () AS row_, * "
                        "FROM read_parquet('{}')",
                        to));
        duck.run(
            "SELECT CASE WHEN (SELECT count(*) FROM text) <> (SELECT count(*) FROM typed) THEN "
            "error('rows') END");
        std::string head;
        std::ifstream in(from);
        std::getline(in, head);
        if (from.ends_with(".gz") || from.ends_with("*.csv.gz")) {
            head =
                "trial_number,interval,tick,time_s,count_1,lateness_us,hip_x_m,rendered_x_n,"
                "commanded_x_n,rendered_normal_n,mu";
        }
        std::string differs;
        for (std::size_t at = 0; at <= head.size();) {
            const std::size_t end = std::min(head.find(',', at), head.size());
            const std::string column = head.substr(at, end - at);
            differs += fmt::format(
                "{1}CASE typeof(typed.\"{0}\") WHEN 'DOUBLE' THEN TRY_CAST(text.\"{0}\" AS DOUBLE) "
                "IS DISTINCT FROM TRY_CAST(typed.\"{0}\" AS DOUBLE) ELSE text.\"{0}\" IS DISTINCT "
                "FROM CAST(typed.\"{0}\" AS VARCHAR) END",
                column, differs.empty() ? "" : " OR ");
            at = end + 1;
        }
        CHECK_NOTHROW(
            duck.run(fmt::format("SELECT CASE WHEN count(*) > 0 THEN error('row ' || min(row_)) "
                                 "END FROM text JOIN typed USING (row_) WHERE {}",
                                 differs)));
    };
    for (const data::ExportTable& table : data::export_tables()) {
        compare(std::string(table.name), (csv / fmt::format("{}.csv", table.name)).string(),
                (parquet / fmt::format("{}.parquet", table.name)).string());
    }
    compare("ticks", (csv / "ticks" / "*.csv.gz").string(), (parquet / "ticks.parquet").string());
    CHECK_THROWS(duck.run("SELECT error('heard')"));
}
