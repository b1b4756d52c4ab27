#include "data/trace/chunk.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/packed_numbers.hpp"
#include "data/trace/replay.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kPeriod = 1'000'000;

data::ChunkView view_of(const data::EncodedChunk& chunk,
                        const std::vector<engine::TickRecord>& ticks,
                        std::uint8_t parts) {
    return {.first_tick = ticks.front().tick,
            .ticks = ticks.size(),
            .period_ns = kPeriod,
            .parts = parts,
            .crc32 = chunk.crc32,
            .derived = data::derived_hash(ticks),
            .data = chunk.data};
}

template <class Word>
bool next(data::PackedNumbers& packed, std::vector<Word>& block) {
    return packed.each<Word>(block.size(),
                             [at = block.data()](Word number) mutable { *at++ = number; });
}

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

TEST_CASE("a chunk that holds all parts comes back to the bit, every field and every NaN") {
    SEEDED(random, std::uint64_t{40});
    auto ticks = random_ticks(seed, 1 + random.index(2048), 7 * random.below(9));
    for (engine::TickRecord& tick : ticks) {  // anything that fits
        tick.time_ns += random.coin() ? random.below(1 << 30) : 0;
        tick.counts[1] =
            std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(random.below(65536)) << 16U |
                                        static_cast<std::uint32_t>(random.below(65536)));
    }
    const auto chunk = data::encode_chunk(ticks, ticks.front().tick, kPeriod, data::kAllParts);
    const data::ChunkView view = view_of(chunk, ticks, data::kAllParts);
    const data::ReplayResult back = data::replay(nullptr, std::nullopt, std::span(&view, 1));
    CHECK_FALSE(back.differs_from);
    REQUIRE(back.ticks.size() == ticks.size());
    std::vector<std::int64_t> hip(ticks.size());
    data::ChunkReader(view).read(data::ColumnId::hip_x, hip);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        REQUIRE(same_bits(ticks[i], back.ticks[i]));
        REQUIRE(hip[i] == data::in_steps(ticks[i].hip.x, data::kHipSteps));
    }
}

TEST_CASE("the hash of ticks is XXH3 of their fields in the order that its header gives") {
    std::vector<engine::TickRecord> ticks;
    for (const int k : {0, 100}) {  // struct.pack("<qq20d6ifhBB", k + 1, ..., k + 30, 2, k + 31)
        engine::TickRecord& tick = ticks.emplace_back();
        const auto three = [k](int first) {
            return engine::Vec3(k + first, k + first + 1, k + first + 2);
        };
        tick.tick = k + 1;
        tick.time_ns = k + 2;
        tick.hip = three(3);
        tick.cp = three(6);
        tick.go = three(9);
        tick.force = three(12);
        tick.command = three(15);
        tick.normal_force = k + 18;
        tick.tangential_force = k + 19;
        tick.mu = k + 20;
        tick.u = k + 21;
        tick.v = k + 22;
        tick.counts = {k + 23, k + 24, k + 25};
        tick.codes = {k + 26, k + 27, k + 28};
        tick.lateness_us = static_cast<float>(k + 29);
        tick.segment = static_cast<std::int16_t>(k + 30);
        tick.mode = engine::Mode::slip;
        tick.flags = static_cast<std::uint8_t>(k + 31);
    }
    CHECK(data::derived_hash(ticks) == 0xb38d3e3581f2db75);
}

TEST_CASE("packed numbers come back in blocks, in the bits that the largest of each needs") {
    SEEDED(random, std::uint64_t{200});
    std::vector<std::uint64_t> numbers(static_cast<std::size_t>(1 + random.below(300)));
    std::size_t expected = 0;
    for (std::size_t first = 0; first < numbers.size(); first += data::kBlock) {
        const std::size_t count = std::min(data::kBlock, numbers.size() - first);
        const int width = random.below(65);
        for (std::size_t i = first; i < first + count; ++i) {
            for (int bit = 0; bit < width; ++bit) {
                numbers[i] = numbers[i] << 1U | (random.coin() ? 1U : 0U);
            }
        }
        if (width > 0) {
            numbers[first] |= std::uint64_t{1} << static_cast<unsigned>(width - 1);
        }
        expected += 1 + (count * static_cast<std::size_t>(width) + 7) / 8;
    }
    std::vector<std::byte> bytes;
    data::pack_numbers(numbers, bytes);
    REQUIRE(bytes.size() == expected);
    data::PackedNumbers packed(bytes);
    for (std::size_t first = 0; first < numbers.size(); first += data::kBlock) {
        std::vector<std::uint64_t> block(std::min(data::kBlock, numbers.size() - first));
        REQUIRE(next(packed, block));
        REQUIRE(std::equal(block.begin(), block.end(),
                           numbers.begin() + static_cast<std::ptrdiff_t>(first)));
    }
    CHECK(packed.at_end());
    for (std::size_t cut = 0; cut < bytes.size();
         ++cut) {  // a short stream is never read beyond its end
        data::PackedNumbers part{std::span(bytes).first(cut)};
        std::size_t read = 0;
        for (std::size_t first = 0; first < numbers.size(); first += data::kBlock) {
            std::vector<std::uint64_t> block(std::min(data::kBlock, numbers.size() - first));
            if (!next(part, block)) {
                break;
            }
            read += block.size();
        }
        REQUIRE(read < numbers.size());
    }
}

TEST_CASE("a number that needs more bits than its column has is refused") {
    std::vector<std::byte> bytes;
    data::pack_numbers(std::vector<std::uint64_t>{std::uint64_t{1} << 32U}, bytes);
    std::vector<std::uint32_t> block(1);
    data::PackedNumbers packed(bytes);
    CHECK_FALSE(next(packed, block));
}

TEST_CASE("a chunk that leaves out what does not follow is noticed, never taken for exact") {
    const auto part =
        GENERATE(data::part_hip, data::part_contact, data::part_command, data::part_lateness);
    const auto ticks = random_ticks(11, 300);
    const auto parts = static_cast<std::uint8_t>(data::kAllParts & ~part);
    const auto chunk = data::encode_chunk(ticks, 0, kPeriod, parts);
    const data::ChunkView view = view_of(chunk, ticks, parts);
    const data::ReplayResult back = data::replay(nullptr, std::nullopt, std::span(&view, 1));
    REQUIRE(back.differs_from);
    CHECK(*back.differs_from == 0);
}

TEST_CASE("no flipped bit, cut or extra byte of a chunk is decoded") {
    const auto ticks = random_ticks(3, 20);
    const auto chunk = data::encode_chunk(ticks, 0, kPeriod, data::kAllParts);
    data::ChunkView view = view_of(chunk, ticks, data::kAllParts);
    std::vector<std::int64_t> values(ticks.size());
    for (std::size_t bit = 0; bit < chunk.data.size() * 8; ++bit) {
        std::vector<std::byte> damaged = chunk.data;
        damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        view.data = damaged;
        REQUIRE_THROWS_AS(data::ChunkReader(view).read(data::ColumnId::tick, values),
                          data::TraceError);
    }
    for (std::size_t cut = 0; cut < chunk.data.size(); cut += 7) {
        view.data = std::span(chunk.data).first(cut);
        REQUIRE_THROWS_AS(data::ChunkReader(view).read(data::ColumnId::tick, values),
                          data::TraceError);
    }
    view.data = chunk.data;
    view.crc32 ^= 1U;
    CHECK_THROWS_AS(data::ChunkReader(view).read(data::ColumnId::tick, values), data::TraceError);
    view.crc32 ^= 1U;
    for (const std::uint8_t parts :
         {std::uint8_t{0}, std::uint8_t{7}}) {  // says that it holds less
        view.parts = parts;
        CHECK_THROWS_AS(data::ChunkReader(view).read(data::ColumnId::tick, values),
                        data::TraceError);
    }
}

TEST_CASE("fixed point rounds to the nearest step, halves up, and says what does not fit") {
    CHECK(data::in_steps(0.25, 10.0) == 3);
    CHECK(data::in_steps(-0.25, 10.0) == -2);
    CHECK(data::in_steps(-0.26, 10.0) == -3);
    CHECK(data::in_steps(1e300, 1.0) == 2147483647);
    CHECK(data::in_steps(-1e300, 1.0) == -2147483647);
    CHECK(data::in_steps(-2147483647.0, 1.0) == -2147483647);
    CHECK(data::in_steps(std::numeric_limits<double>::quiet_NaN(), 1.0) == data::kNotANumber);
    CHECK(data::in_steps(-std::numeric_limits<double>::infinity(), 1.0) == data::kNotANumber);
}

TEST_CASE("every byte of a tick belongs to exactly one column") {
    std::vector<int> owners(sizeof(engine::TickRecord), 0);
    for (const data::TraceColumn& column : data::trace_columns()) {
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            ++owners.at(column.offset + byte);
        }
    }
    CHECK(std::count(owners.begin(), owners.end(), 1) ==
          static_cast<std::ptrdiff_t>(owners.size()));
}

TEST_CASE(
    "Python reads the same numbers from the CSV files as from the database, R those of Python") {
    const ExportSummary exported("csv");
    const Finished python =
        ended(Process({"python3", "-c", kPython, exported.file, exported.out.string()}).wait());
    CHECK_THAT(python.out, !Has("0 0"));
    const std::string ticks = fs::directory_iterator(exported.out / "ticks")->path().string();
    const std::string by_r = exported.folder.file("r.bin");
    const std::string by_python = exported.folder.file("python.bin");
    if (!has_r()) {
        return;
    }
    ended(Process({"Rscript", "--vanilla", "-e", kR, ticks, by_r}).wait());
    ended(Process({"python3", "-c",
                   "import csv, gzip, struct, sys\n"
                   "names = ['hip_x_m', 'hip_y_m', 'rendered_x_n', 'rendered_y_n', 'u']\n"
                   "with open(sys.argv[2], 'wb') as out:\n"
                   "    for t in csv.DictReader(gzip.open(sys.argv[1], 'rt')):\n"
                   "        out.write(struct.pack('<5d', *(float(t[n]) for n in names)))\n",
                   ticks, by_python})
              .wait());
    CHECK(slurp(by_r).size() > 100'000);
    CHECK((slurp(by_r) == slurp(by_python)));
}

TEST_CASE("a BIDS export has what the standard requires of each file") {
    const ExportSummary exported("bids");
    ended(Process(
              {"python3", "-c", test_text("scripts/bids.py"), exported.file, exported.out.string()})
              .wait());
}

TEST_CASE("a Psych-DS export describes every column of its data") {
    const ExportSummary exported("psych-ds");
    ended(
        Process({"python3", "-c", test_text("scripts/psych_ds.py"), exported.out.string()}).wait());
}

TEST_CASE("Parquet without DuckDB is one sentence with the remedy, and nothing is made") {
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
