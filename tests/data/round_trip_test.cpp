#include "data/store/database.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

namespace {

/// A demo's file and its export with all ticks.
struct ExportSummary {
    explicit ExportSummary(const std::string& format) {
        file = folder.file("demo.sqlite");
        out = folder.path() / "out";
        ran({"demo", "--headless", "--db", file});
        ran({"export", file, "--format", format, "--kind", "simulated", "--traces", "-o",
             out.string()});
    }
    TemporaryFolder folder;
    std::string file;
    fs::path out;
};

/// Every number of trials.csv and of the ticks against the file, with Python's standard library
/// alone and the reader that ships.
const std::string kPython = test_text("scripts/round_trip.py");

/// What R's own reader makes of a file, every number as its bits.
const std::string kR = test_text("scripts/numbers.R");

}  // namespace

TEST_CASE(
    "Python reads the same numbers from the CSV files as from the database, R those of Python",
    "[export][law]") {
    const ExportSummary exported("csv");
    const Finished python =
        Process({"python3", "-c", kPython, exported.file, exported.out.string()}).wait();
    CAPTURE(python.error);
    if (python.code == 127) {
        WARN("skipped: no python3 is installed");
        return;
    }
    CHECK(python.code == 0);
    CHECK_THAT(python.out, !Has("0 0"));
    const std::string ticks = fs::directory_iterator(exported.out / "ticks")->path().string();
    const std::string by_r = exported.folder.file("r.bin");
    const std::string by_python = exported.folder.file("python.bin");
    const Finished r = Process({"Rscript", "--vanilla", "-e", kR, ticks, by_r}).wait();
    if (r.code == 127) {
        WARN("skipped: no R is installed");
        return;
    }
    CAPTURE(r.error);
    REQUIRE(r.code == 0);
    const Finished bits =
        Process({"python3", "-c",
                 "import csv, gzip, struct, sys\n"
                 "names = ['hip_x_m', 'hip_y_m', 'rendered_x_n', 'rendered_y_n', 'u']\n"
                 "with open(sys.argv[2], 'wb') as out:\n"
                 "    for t in csv.DictReader(gzip.open(sys.argv[1], 'rt')):\n"
                 "        out.write(struct.pack('<5d', *(float(t[n]) for n in names)))\n",
                 ticks, by_python})
            .wait();
    CAPTURE(bits.error);
    REQUIRE(bits.code == 0);
    CHECK(slurp(by_r).size() > 100'000);
    CHECK((slurp(by_r) == slurp(by_python)));
}

TEST_CASE("a BIDS export has what the standard requires of each file", "[export][law]") {
    const ExportSummary exported("bids");
    const Finished python = Process({"python3", "-c", test_text("scripts/bids.py"), exported.file,
                                     exported.out.string()})
                                .wait();
    CAPTURE(python.error);
    CHECK(python.code == 0);
}

TEST_CASE("a Psych-DS export describes every column of its data", "[export][law]") {
    const ExportSummary exported("psych-ds");
    const Finished python =
        Process({"python3", "-c", test_text("scripts/psych_ds.py"), exported.out.string()}).wait();
    CAPTURE(python.error);
    CHECK(python.code == 0);
}

TEST_CASE("Parquet without DuckDB is one sentence with the remedy, and nothing is made",
          "[export]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("demo.sqlite");
    ran({"demo", "--headless", "--db", file});
    const Finished done = Process({palpate_program(), "export", file, "--format", "parquet",
                                   "--kind", "simulated", "-o", folder.file("out")},
                                  {"PALPATE_DUCKDB=/none/libduckdb.so"})
                              .wait();
    check_end(done, 2, Has("PALPATE_DUCKDB"));
    CHECK_FALSE(fs::exists(folder.file("out")));
}
