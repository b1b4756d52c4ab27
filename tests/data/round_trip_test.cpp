#include "data/store/database.hpp"
#include "tests/support/program.hpp"

using namespace palpate;
using namespace palpate::tests;
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
constexpr const char* kPython = R"py(
import csv, gzip, json, sqlite3, struct, sys
file, out = sys.argv[1:3]
bits = lambda x: struct.pack("<d", x)
db = sqlite3.connect(file)
db.row_factory = sqlite3.Row
rows = db.execute("SELECT trial.*, reaction_s, reaction_uncertainty_s, mu_s, curvature_per_m FROM trial"
                  " JOIN plan USING (session_id, plan_position) LEFT JOIN response USING (trial_id)"
                  " ORDER BY trial.trial_id").fetchall()
written = list(csv.DictReader(open(f"{out}/trials.csv", newline="")))
assert len(rows) == len(written) == 10, (len(rows), len(written))
seen = 0
for row, line in zip(rows, written):
    for name in row.keys():
        if name in line and isinstance(row[name], float):
            assert bits(float(line[name])) == bits(row[name]), (name, line[name], row[name])
            seen += 1
        elif name in line and isinstance(row[name], int):
            assert int(line[name]) == row[name]
columns = {(c["table"], c["column"]) for c in csv.DictReader(open(f"{out}/columns.csv"))}
for table in ("trials", "responses", "sessions", "plan", "events", "participants", "pictures"):
    for name in next(csv.reader(open(f"{out}/{table}.csv"))):
        assert (table, name) in columns, (table, name)
ticks = 0
for row, line in zip(rows, written):
    name = f"{out}/ticks/{line['subject']}_shapefrictiondemo_ses-01_trial-{int(line['trial_number']):04}.csv.gz"
    hip = [float(t["hip_x_m"]) for t in csv.DictReader(gzip.open(name, "rt"))]
    assert len(hip) == row["ticks"] or len(hip) > row["ticks"]
    ticks += len(hip)
print(seen, ticks)
)py";

/// What R's own reader makes of a file, every number as its bits.
constexpr const char* kR = R"r(
words <- commandArgs(trailingOnly = TRUE)
table <- read.csv(gzfile(words[1]), stringsAsFactors = FALSE, colClasses = "character")
numbers <- sapply(c("hip_x_m", "hip_y_m", "rendered_x_n", "rendered_y_n", "u"),
                  function(name) as.numeric(table[[name]]))
plain <- read.csv(gzfile(words[1]), stringsAsFactors = FALSE)
stopifnot(identical(as.vector(numbers[, "rendered_x_n"]), as.numeric(plain$rendered_x_n)))
writeBin(as.vector(t(numbers)), words[2], size = 8, endian = "little")
)r";

}  // namespace

TEST_CASE("Python reads the same numbers from the CSV files as from the database",
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
}

TEST_CASE("R reads every number of the ticks to the bit that Python reads", "[export][law]") {
    const ExportSummary exported("csv");
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
    const Finished python =
        Process({"python3", "-c",
                 "import csv, gzip, struct, sys\n"
                 "names = ['hip_x_m', 'hip_y_m', 'rendered_x_n', 'rendered_y_n', 'u']\n"
                 "with open(sys.argv[2], 'wb') as out:\n"
                 "    for t in csv.DictReader(gzip.open(sys.argv[1], 'rt')):\n"
                 "        out.write(struct.pack('<5d', *(float(t[n]) for n in names)))\n",
                 ticks, by_python})
            .wait();
    CAPTURE(python.error);
    REQUIRE(python.code == 0);
    CHECK(slurp(by_r).size() > 100'000);
    CHECK((slurp(by_r) == slurp(by_python)));
}

TEST_CASE("a BIDS export has what the standard requires of each file", "[export][law]") {
    const ExportSummary exported("bids");
    const Finished python = Process({"python3", "-c", R"py(
import csv, gzip, json, pathlib, re, sqlite3, sys
out = pathlib.Path(sys.argv[2])
described = json.loads((out / "dataset_description.json").read_text())
assert described["Name"] and re.fullmatch(r"\d+\.\d+\.\d+", described["BIDSVersion"])
assert (out / "README").stat().st_size > 150
tsv = lambda path: list(csv.reader(open(path, newline=""), delimiter="\t"))
people = tsv(out / "participants.tsv")
assert people[0][0] == "participant_id"
subjects = [row[0] for row in people[1:]]
assert sorted(subjects) == sorted(p.name for p in out.glob("sub-*"))
json.loads((out / "participants.json").read_text())
entity = r"sub-[0-9a-zA-Z]+_ses-[0-9a-zA-Z]+_task-[0-9a-zA-Z]+"
run = r"_tracksys-[0-9a-zA-Z]+(_acq-[0-9a-zA-Z]+)?_run-\d+"
for path in out.rglob("*_beh.tsv"):
    assert re.fullmatch(entity + "_beh.tsv", path.name)
    head, *rows = tsv(path)
    words = json.loads(path.with_suffix(".json").read_text())
    assert words["TaskName"] and all("Description" in words[name] for name in head)
    assert len(rows) == 10 and all(len(row) == len(head) for row in rows)
    assert all(cell != "" for row in rows for cell in row)
runs = 0
for path in out.rglob("*_motion.tsv"):
    runs += 1
    assert re.fullmatch(entity + run + "_motion.tsv", path.name)
    stem = str(path)[:-len("motion.tsv")]
    head, *channels = tsv(stem + "channels.tsv")
    assert head[:6] == ["name", "component", "type", "tracked_point", "units", "reference_frame"]
    frames = json.loads(open(stem + "channels.json").read())["reference_frame"]["Levels"]
    assert all((c[1] == "n/a") == (c[5] == "n/a") and c[5] in {"n/a", *frames} for c in channels)
    kinds = [c[2] for c in channels]
    assert set(kinds) <= {"POS", "LATENCY", "MISC"} and set(c[1] for c in channels) <= {"x", "y", "z", "n/a"}
    words = json.loads(open(stem + "motion.json").read())
    for name in ("SamplingFrequency", "TaskName", "TrackingSystemName"):
        assert words[name]
    for kind in set(kinds):
        assert words[kind + "ChannelCount"] == kinds.count(kind)
    rows = tsv(path)
    assert all(len(row) == len(channels) == words["MotionChannelCount"] for row in rows)
    force = path.parent.parent / "beh" / path.name.replace("_tracksys-handle", "")
    force = str(force)[:-len("motion.tsv")] + "recording-force_stim"
    stim = json.loads(open(force + ".json").read())
    assert stim["StartTime"] == 0 and stim["SamplingFrequency"] == words["SamplingFrequency"]
    lines = gzip.open(force + ".tsv.gz", "rt").read().splitlines()
    assert len(lines) == len(rows) and all(len(l.split("\t")) == len(stim["Columns"]) for l in lines)
    at = [c[0] for c in channels].index("time_s")
    assert all(re.fullmatch(r"\d+\.\d{9}", row[at]) for row in rows)
    assert float(rows[0][at]) == 0 and abs(float(rows[-1][at]) - (len(rows) - 1) / 1000) < 1e-6
assert runs == 10
)py",
                                     exported.file, exported.out.string()})
                                .wait();
    CAPTURE(python.error);
    CHECK(python.code == 0);
}

TEST_CASE("a Psych-DS export describes every column of its data", "[export][law]") {
    const ExportSummary exported("psych-ds");
    const Finished python = Process({"python3", "-c", R"py(
import csv, json, pathlib, re, sys
out = pathlib.Path(sys.argv[1])
described = json.loads((out / "dataset_description.json").read_text())
assert described["@context"].rstrip("/").endswith("schema.org") and described["@type"] == "Dataset"
assert described["name"] and described["description"]
named = {v["name"] for v in described["variableMeasured"]}
files = list((out / "data").iterdir())
assert len(files) == 12
for path in files:
    assert re.fullmatch(r"([a-z]+-[A-Za-z0-9]+_)+data\.csv", path.name), path.name
    with open(path, newline="") as text:
        head, *rows = csv.reader(text)
    assert set(head) <= named, set(head) - named
    assert all(len(row) == len(head) for row in rows)
)py",
                                     exported.out.string()})
                                .wait();
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
