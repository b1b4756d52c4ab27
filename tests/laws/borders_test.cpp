#include "engine/base/text.hpp"
#include "data/csv/csv_text.hpp"
#include "data/csv/json_text.hpp"
#include "data/store/database.hpp"
#include "tests/support/program.hpp"
#include "tests/support/random.hpp"

namespace {

/// Hides, retitles, turns the line round, is no UTF-8: ESC, C1's CSI, BEL, DEL, an override, a lone
/// byte.
const std::string kOrders =
    "A\x1b[2J\x1b]0;t\x07\x7f\xc2\x9b"
    "31m\xe2\x80\xae"
    "B\xff\r";

/// Nothing in it is an order to a terminal.
bool only_shows(const std::string& text) {
    return plain(text, palpate::Lines::kept) == text;
}

}  // namespace

TEST_CASE("what a terminal is sent is only shown, whatever the bytes") {
    Random random(10);
    for (int i = 0; i < 2'000; ++i) {
        std::string bytes;
        for (int n = random.below(30); n > 0; --n) {
            bytes += static_cast<char>(random.below(256));
        }
        CAPTURE(i);
        const std::string shown = plain(bytes);
        CHECK(is_utf8(shown));
        for (const char c : shown) {
            CHECK(static_cast<unsigned char>(c) >= 0x20);
        }
        CHECK(plain(shown) == shown);
        CHECK(only_shows(data::json_string(bytes)));
    }
    CHECK(plain(kOrders) == "A\\x1b[2J\\x1b]0;t\\x07\\x7f\\u{9b}31m\\u{202e}B\\xff\\x0d");
    CHECK(plain("çukur, 凹\n\tx") == "çukur, 凹  x");
}

TEST_CASE("no text of a spreadsheet's field is a formula, and what was there can be read back") {
    const auto back = [](std::string field) {  // as csv_text.hpp says
        if (field.size() >= 2 && field.front() == '"') {
            field = field.substr(1, field.size() - 2);
        }
        const std::size_t first = field.find_first_not_of('\'');
        const bool marked = first != 0 && first != std::string::npos &&
                            std::string("=+-@\t\r\n").find(field[first]) != std::string::npos;
        return marked ? field.substr(1) : field;
    };
    for (const std::string text :
         {"=HYPERLINK(1)", "+1+1",   "-A1",  "@SUM(A1)", "\tx", "\r=1",    "\n=1", "'=x",
          "''-y",          "'plain", "-",    "-inf",     "-5",  "+3.5e-7", "1",    "a=b",
          "'-5",           "--1",    "-1-1", ""}) {
        CAPTURE(text);
        const std::string field = data::csv_field(text);
        CHECK(back(field) == text);
        const std::string bare = field.front() == '"' ? field.substr(1) : field;
        const bool number = text == "-5" || text == "+3.5e-7" || text == "-inf";
        CHECK((number || std::string("=+-@\t\r\n").find(bare.front()) == std::string::npos));
        CHECK((!number || field == text));
        CHECK((number ||
               std::string("=+-@\t\r\n").find(data::tsv_field(text).front()) == std::string::npos));
    }
}

TEST_CASE("nothing that a file holds is an order to the terminal of who reads it") {
    const TemporaryFolder folder;
    const std::string db = folder.file("d.sqlite");
    ran(run_words("shape_friction_demo", "P1", db, {"--headless", "--operator", "@SUM(A1)"}));
    ran({"note", db, "=HYPERLINK(\"http://x\",\"y\")", "--participant", "P1"});
    ran({"note", db, "-5", "--participant", "P1"});
    ran({"participant", db, "P1", "--set", "from=+1+1", "--set", "age=-3"});
    // A note is a formula nowhere, and a number stays one.
    const std::string out = folder.file("csv");
    ran({"export", db, "--kind", "all", "--with-details", "-o", out});
    std::string all;
    for (const auto& file : std::filesystem::directory_iterator(out)) {
        all += slurp(file.path());
    }
    CHECK_THAT(all, Has("\"'=HYPERLINK(", "'@SUM(A1)", "'+1+1", ",-3"));
    CHECK_THAT(all, !Has("'-"));
    const std::string csv =
        sql_csv(db, "SELECT text, -1 AS n FROM event WHERE event_kind = 'note'");
    CHECK_THAT(csv, Has("\"'=HYPERLINK(\"\"http://x\"\",\"\"y\"\")\",-1\n"));

    {
        data::Database database(db, data::Access::write);
        database.execute("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON");
        for (const std::string& change : lines_in(test_text("edits/orders.sql"))) {
            try {
                auto row = database.first(change, kOrders);
            } catch (const data::StoreError&) {  // a trigger or another table holds on to it
            }
        }
        auto there = database.first("SELECT count(*) FROM event WHERE text = ?1", kOrders);
        REQUIRE(there.integer(0) > 0);
    }
    const std::string other = folder.file("other.sqlite");
    for (const Words& words :
         std::vector<Words>{{"summary", db},
                            {"verify", db},
                            {"verify", db, "--json"},
                            {"sql", db, "-c", "SELECT * FROM event; SELECT * FROM session"},
                            {"sql", db, "--json", "-c", "SELECT * FROM event"},
                            {"sql", db, "-c", "SELECT '" + kOrders + "' FROM nothing"},
                            {"sql", db, "-c", ".columns " + kOrders},
                            {"participant", db, "P1"},
                            {"note", db, "x", "--participant", "P1"},
                            {"note", db, "x", "--participant", "P1", "--study", kOrders},
                            {"export", db, "--kind", "all", "-o", folder.file("out")},
                            {"merge", other, db},
                            {"summary", folder.file(kOrders)},
                            {"check", folder.file(kOrders)},
                            {"check", "shape_friction", "--device", kOrders},
                            run_words("shape_friction", kOrders, other),
                            {"run", "shape_friction", "--kind", kOrders},
                            {kOrders},
                            {"run", "--" + kOrders},
                            {"sequence", "shape_friction", kOrders}}) {
        CAPTURE(words.front());
        const Finished done = palpate_command(words);
        CAPTURE(done.out, done.error, words.size() > 1 ? words[1] : "");
        CHECK(done.code < 128);
        CHECK(only_shows(done.out));
        CHECK(only_shows(done.error));
    }
    const Finished json = palpate_command({"sql", db, "--json", "-c", "SELECT * FROM event"});
    const std::string rows = write(folder.file("rows.json"), json.out);
    CHECK(Process({"python3", "-m", "json.tool", rows}).wait().code == 0);
}
