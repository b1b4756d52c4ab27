#include <nlohmann/json.hpp>

#include "data/export/csv_export.hpp"
#include "data/export/export.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/people.hpp"
#include "data/store/uuid.hpp"
#include "tests/support/adaptive.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

using namespace palpate::data;

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kClock = 432'198'765'000'000;  ///< ns

/// Three participants of a study, with words that must not leave the lab.
std::string exported_database(const TemporaryFolder& folder) {
    const std::string file = folder.file("study.sqlite");
    Database database(file, Access::write);
    for (const char* code : {"SECRETP1", "SECRETP2", "SECRETP3"}) {
        data::SessionSpec spec = session_spec(small_protocol(), code);
        spec.kind = data::RunKind::real;
        spec.key.secret = data::random_secret();
        spec.operator_name = "SECRET operator";
        spec.device = "Haply 2diy_gen3 at /SECRET/tty";
        spec.provenance = {{"host", "SECRET host"}};
        const std::int64_t session = data::open_session(database, spec).id;
        data::add_note(database, session, "SECRET note");
        data::note_participant(database, code,
                               {.handedness = 60, .details = {{"age", "SECRET age"}}});
        database.run(
            "INSERT INTO trial (device, session_id, plan_position, attempt, outcome, started_utc, "
            "done_s) VALUES ('Haply 2diy_gen3 at /SECRET/tty', ?1, 0, 1, 'complete', ?2, 1.25)",
            session, data::utc_now());
        const std::int64_t trial = database.last_row();
        // The servo's clock tells who came first.
        database.run("UPDATE trial SET started_ns = ?2 WHERE trial_id = ?1", trial,
                     kClock + 1000 * trial);
        database.run("UPDATE event SET at_ns = ?2 WHERE session_id = ?1", session,
                     kClock + 1000 * trial + 70);
        database.run(
            "INSERT INTO response (trial_id, chosen_place, chosen_object, correct, reaction_s, "
            "reaction_uncertainty_s, input, answer_code) VALUES (?1, 0, 'straight', 1, 0.7, 0.0, "
            "'key', 0)",
            trial);
        (void)data::mark_invalid(database, trial, {"SECRET reason"});
    }
    return file;
}

}  // namespace

TEST_CASE("a number's text is read back to the same bits") {
    Random random(GENERATE(range(0U, 4U)));
    for (int i = 0; i < 50'000; ++i) {
        const std::uint64_t word = static_cast<std::uint64_t>(random.in(0.0, 0x1p32)) << 32U |
                                   static_cast<std::uint64_t>(random.in(0.0, 0x1p32));
        const double value = i % 2 == 0 ? std::bit_cast<double>(word) : random.in(-1.0, 1.0);
        if (std::isfinite(value)) {
            const double back = std::strtod(data::number_text(value).c_str(), nullptr);
            CHECK(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(value));
        }
    }
    CHECK(data::number_text(0.1) == "0.1");
    CHECK(data::number_text(-std::numeric_limits<double>::infinity()) == "-inf");
}

TEST_CASE("nothing that tells who somebody is leaves the file unless it is asked for") {
    const auto format = GENERATE(ExportFormat::csv, ExportFormat::bids, ExportFormat::psych_ds);
    const TemporaryFolder folder;
    const std::string file = exported_database(folder);
    const fs::path plain = folder.path() / "plain";
    CHECK(data::export_file(file, format, {}, plain).sessions == 3);
    const std::string text = everything(plain);
    CHECK_THAT(text, !Has("SECRET"));
    const std::string cell = format == ExportFormat::bids ? "\t" : ",";
    CHECK_THAT(text, Has(cell + "Haply 2diy_gen3" + cell, "trial_device"));
    CHECK_THAT(text, !Has(data::utc_now().substr(0, 10)));
    CHECK_THAT(text, !Has("432198765"));
    CHECK_THAT(text, Has("sub-"));

    const fs::path open = folder.path() / "open";
    (void)data::export_file(file, format, {.details = true, .keep_codes = true}, open);
    CHECK_THAT(everything(open), Has("SECRETP2"));
    CHECK((fs::status(open).permissions() & (fs::perms::group_all | fs::perms::others_all)) ==
          fs::perms::none);
    if (format == ExportFormat::csv) {
        for (const char* word : {"SECRET operator", "SECRET note", "SECRET age", "SECRET host",
                                 "SECRET reason", "/SECRET/tty", "432198765"}) {
            CHECK_THAT(everything(open), Has(word));
        }
    }
}

TEST_CASE(
    "the same file gives the same export, and its subjects are not in the order of their codes") {
    const TemporaryFolder folder;
    std::set<std::string> orders;
    for (int i = 0; i < 8; ++i) {
        const TemporaryFolder inner;
        const std::string file = exported_database(inner);
        (void)data::export_file(file, ExportFormat::csv, {.keep_codes = true}, inner.path() / "a");
        (void)data::export_file(file, ExportFormat::csv, {.keep_codes = true}, inner.path() / "b");
        CHECK(everything(inner.path() / "a") == everything(inner.path() / "b"));
        orders.insert(slurp(inner.path() / "a" / "codes.csv"));
    }
    CHECK(orders.size() > 1);  // by chance all eight alike: 1 in 6^7
}

TEST_CASE("an export is whole or not there, and takes nobody's folder") {
    const TemporaryFolder folder;
    const std::string file = exported_database(folder);
    const fs::path taken = folder.path() / "taken";
    fs::create_directory(taken);
    std::ofstream(taken / "thesis.txt") << "mine";
    CHECK_THROWS_AS(data::export_file(file, ExportFormat::csv, {}, taken), std::invalid_argument);
    CHECK(everything(taken) == "thesis.txt\nmine");
    CHECK_THROWS_AS(
        data::export_file(file, ExportFormat::csv, {.kind = "pilot"}, folder.path() / "p"),
        std::invalid_argument);
    sql_edit(file,
             "INSERT INTO trace_chunk (trial_id, interval, first_tick, ticks, codec, period_ns, "
             "holds, crc32, derived, data) VALUES (1, 1, 0, 1, 1, 1000000, '', 0, 0, x'0102')");
    CHECK_THROWS(data::export_file(file, ExportFormat::csv, {.traces = true}, folder.path() / "t"));
    for (const std::string& name : folder.names()) {
        CHECK_THAT(name, !Has("part"));
    }
    CHECK_FALSE(fs::exists(folder.path() / "p"));
    CHECK_FALSE(fs::exists(folder.path() / "t"));
}

TEST_CASE("every column of the file is exported or marked to stay in the file") {
    std::string sql;
    for (const data::ExportTable& table : data::export_tables()) {
        for (const data::ExportColumn& column : table.columns) {
            sql += fmt::format("{} ", column.sql);
        }
    }
    const TemporaryFolder folder;
    Database database(exported_database(folder), Access::read);
    for (const auto& column : database.prepare(
             "SELECT t.name, c.name FROM sqlite_schema AS t, pragma_table_info(t.name) AS c WHERE "
             "t.type = 'table' AND t.name NOT IN ('trace_chunk', 'trace_column', 'fault_tick')")) {
        const std::string name = column.text(0) + '.' + column.text(1);
        CAPTURE(name);
        const bool stays = data::find_column(name)->seen == data::Visibility::file ||
                           column.text(0) == "secret" || name == "adaptive_plan.plan_position";
        CHECK((stays || sql.find(name) != std::string::npos));
    }
}

TEST_CASE("palpate procedure prints the stored states of every exported run") {
    const std::string rule = GENERATE(kQuestPlusRule, kStaircaseRule);
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    Database database(file, Access::write);
    for (const char* who : {"P01", "P02"}) {
        const auto spec = session_spec(adaptive_protocol(rule), who);
        REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    }
    ran({"export", file, "--format", "procedure", "--kind", "all", "-o", folder.file("out")});
    std::size_t replayed = 0;
    for (const auto& run : std::filesystem::directory_iterator(folder.file("out"))) {
        const std::string name = run.path().filename();
        CAPTURE(name);
        if (name == "README.txt") {
            continue;
        }
        const Finished shown = ran(
            {"procedure", run.path() / "CONFIG.toml", run.path() / "RESPONSES.csv", "--hashes"});
        CHECK_THAT(slurp(run.path() / "CONFIG.toml"), !Has("P0") && !Has(kSecret));
        data::Statement person = database.prepare(
            "SELECT participant_code FROM participant WHERE instr(?1, printf('subject-%010d_', "
            "subject))");
        REQUIRE(person.bind(1, std::string_view(name)).step());
        const std::string who = person.text(0);
        data::Statement row = database.prepare(
            "SELECT stimulus, rule_outcome, state_sha256 FROM analysis_trial WHERE "
            "run_trial_number IS NOT NULL AND participant_code = ?1 AND run_number = ?2 ORDER BY "
            "run_trial_number",
            who, name.back() - '0');
        const auto lines = lines_in(shown.out);
        REQUIRE(lines.size() == 8);
        CHECK_THAT(lines[0], Has("state_sha256"));
        std::size_t n = 0;
        for (; row.step(); ++n) {
            const std::string& line = lines.at(n + 1);
            CAPTURE(line);
            REQUIRE(line.starts_with(fmt::format("{},{},{},", n + 1, row.real(0), row.integer(1))));
            REQUIRE(line.ends_with("," + row.text(2)));
        }
        CHECK(n == 7);
        ++replayed;
    }
    CHECK(replayed == 4);
}

TEST_CASE("a file without a rule has no runs to export") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    {
        Database database(file, Access::write);
        static_cast<void>(data::open_session(database, session_spec(small_protocol())));
    }
    CHECK_THAT(
        ran({"export", file, "--format", "procedure", "--kind", "all", "-o", folder.file("out")}, 2)
            .error,
        Has("no session"));
    CHECK_FALSE(std::filesystem::exists(folder.file("out")));
}

TEST_CASE("of a rule on friction exports have what was compared, and say whose the plan's mu is") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"simulate", "friction_threshold", "--participants", "1", "--no-traces", "--db", file});
    ran({"export", file, "--kind", "simulated", "-o", folder.file("out")});
    std::string exported = "comparison_mu_s,comparison_mu_d,comparison_curvature_per_m\n";
    for (auto& trial : csv_records(slurp(folder.file("out/trials.csv")))) {
        exported +=
            fmt::format("{},{},{}\n", trial.at("comparison_mu_s"), trial.at("comparison_mu_d"),
                        trial.at("comparison_curvature_per_m"));
    }
    CHECK(exported ==
          sql_csv(file,
                  "SELECT mu_s AS comparison_mu_s, mu_d AS comparison_mu_d, curvature_per_m AS "
                  "comparison_curvature_per_m FROM presentation JOIN trial USING (trial_id) JOIN "
                  "adaptive_plan USING (session_id, plan_position) WHERE interval = "
                  "comparison_interval ORDER BY trial_id"));
    for (const data::ExportColumn& column : data::export_table("trials").columns) {
        if (column.name == "mu_s" || column.name == "mu_d") {
            CHECK_THAT(column.meaning, Has("whatever a rule chose"));
        }
    }
}

TEST_CASE("an export says how many sessions are in its folder, of what kind, and which are not") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const std::string graded = folder.file("graded.sqlite");
    const std::string shapes = folder.file("shapes.sqlite");
    ran({"simulate", "curvature_2afc", "--participants", "2", "--no-traces", "--db", graded});
    ran({"simulate", "shape_friction_demo", "--participants", "3", "--no-traces", "--db", shapes});
    ran({"merge", file, graded, shapes});
    sql_edit(file,
             "UPDATE session SET session_kind = 'pilot' WHERE session_id IN (SELECT "
             "min(session_id) FROM session GROUP BY study_id)");
    for (const std::string format : {"quickpsy", "psignifit", "procedure", "psychopy"}) {
        CAPTURE(format);
        const std::string out = folder.file(format);
        const Json said = Json::parse(
            ran({"export", file, "--kind", "all", "--as", format, "--json", "-o", out}).out);
        const bool all = format == "psychopy";
        CHECK(said["sessions"] == (all ? 5 : 2));
        CHECK(said["left_out"].size() == (all ? 4 : 2));
        CHECK(said["not_taken"].size() == (all ? 0 : 2));
        const std::string readme = slurp(out + "/README.txt");
        if (!all) {
            CHECK(said["not_taken"][1] ==
                  Json({{"study", "shape_friction_demo"}, {"kind", "simulated"}, {"sessions", 2}}));
            CHECK_THAT(readme, Has("of 1 pilot session of study shape_friction_demo: ",
                                   "of 2 simulated sessions of study shape_friction_demo: ") &&
                                   !Has("left out of study shape_friction_demo"));
            continue;
        }
        std::map<std::string, int> kinds;
        for (const auto& session : fs::directory_iterator(out)) {
            if (session.path().extension() == ".csv") {
                ++kinds[csv_records(slurp(session.path())).at(0).at("kind")];
            }
        }
        CHECK(kinds == std::map<std::string, int>{{"pilot", 2}, {"simulated", 3}});
    }
}

TEST_CASE("what lies beside an export says no more than is there, and all of it") {
    const TemporaryFolder folder;
    const std::string file = exported_database(folder);
    ran({"export", file, "--keep-codes", "-o", folder.file("csv")});
    CHECK_THAT(slurp(folder.file("csv/columns.csv")),
               Has("\ncodes,subject,text,", "\ncodes,participant_code,text,",
                   "\nresponses,answer_code,integer,1,", "; level - 1\","));
    ran({"export", file, "--as", "bids", "--traces", "-o", folder.file("bids")});  // without ticks
    CHECK_THAT(slurp(folder.file("bids/README")),
               Has("there is no motion and no stim") && !Has("motion (") && !Has("pantograph"));
}
