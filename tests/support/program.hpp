#pragma once

#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/test_text.hpp"

/// The program under test, asked in one line.
namespace palpate::tests {

/// What has ended, as it must, with `code`.
inline Finished ended(const Finished& done, int code = 0) {
    CAPTURE(done.out, done.error);
    REQUIRE(done.code == code);
    return done;
}

/// palpate_command(), whose exit code must be `code`.
inline Finished ran(const Words& words, int code = 0) {
    CAPTURE(words);
    return ended(palpate_command(words), code);
}

/// A protocol, shipped or a file, run by people one after the other. @return the file of sessions
inline std::string run_by(const Words& people,
                          const std::string& protocol,
                          const std::string& file) {
    for (const std::string& one : people) {
        ran(run_words(protocol, one, file, {"--headless"}));
    }
    return file;
}

/// A file of sessions, which goes with it.
struct RunFile : TemporaryFile {
    explicit RunFile(const std::string& protocol, const Words& people = {"P1"})
        : TemporaryFile("d.sqlite") {
        run_by(people, protocol, *this);
    }
};

/// The demo, as slow as asked for: "0" is at once.
inline Words demo_words(const std::string& file,
                        const std::string& participant = "P1",
                        const std::string& speed = "0") {
    return run_words("shape_friction_demo", participant, file,
                     {"--headless", "--speed", speed, "--secret", kRunSecret});
}

/// Whether another program does what it is asked; a warning says where `what` is missing.
inline bool installed(const std::string& what, const Words& asks) {
    const bool there = Process(asks).wait().code == 0;
    if (!there) {
        WARN(what << " is not installed: not checked");
    }
    return there;
}
inline bool has_r() {
    return installed("R", {"Rscript", "-e", "1"});
}

/// A program ended with `code`, and said why.
template <class Matcher>
void check_end(const Finished& end, int code, const Matcher& why) {
    CAPTURE(end.out, end.error);
    CHECK(end.code == code);
    CHECK_THAT(end.error, why);
}

/// What palpate render or closest says of a scene and a table of points.
inline std::string said_of(const std::string& command,
                           const std::string& scene,
                           const std::string& table) {
    const TemporaryFolder folder;
    write(folder.file("s.toml"), scene);
    write(folder.file("d.csv"), table);
    const Finished done = ran({command, folder.file("s.toml"), folder.file("d.csv")});
    REQUIRE(done.error.empty());
    return done.out;
}

/// Numbers by the name of their column.
using Columns = std::map<std::string, std::vector<double>>;

/// The columns of a CSV without quotes; a word that is no number is NaN.
inline Columns columns_in(const std::string& csv) {
    Columns columns;
    for (const auto& row : csv_records(csv)) {
        for (const auto& [name, field] : row) {
            char* end = nullptr;
            const double value = std::strtod(field.c_str(), &end);
            columns[name].push_back(end == field.c_str() ? std::nan("") : value);
        }
    }
    return columns;
}

/// The most by which a number of `a` differs from `factor` times that of `b`; infinite where one of
/// them is none, or there are more of one than of the other.
inline double apart(const std::vector<double>& a,
                    const std::vector<double>& b,
                    double factor = 1.0) {
    double most = a.size() == b.size() ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        const double off = std::fabs(a[i] - factor * b[i]);
        most = off <= most ? most : std::isnan(off) ? std::numeric_limits<double>::infinity() : off;
    }
    return most;
}

/// What palpate sql says of a database, as CSV.
inline std::string sql_csv(const std::string& file, const std::string& query) {
    return ran({"sql", file, "--csv", "-c", query}).out;
}

/// Its first row, without the head.
inline std::string sql_row(const std::string& file, const std::string& query) {
    return behind(sql_csv(file, query), "\n");
}

/// What a table of tests/texts has: a query of a file and its first row; "1" where that is left out.
inline void check_truths(const std::string& file, const std::string& table) {
    for (const Words& row : test_rows(table)) {
        CAPTURE(row);
        CHECK(sql_row(file, row.at(0)) == (row.size() > 1 ? row[1] : "1"));
    }
}

/// Simulated people who answer to a protocol's text: the file.
inline std::string simulated_study(const TemporaryFolder& folder,
                                   const std::string& protocol,
                                   const Words& more) {
    const std::string file = folder.file("s.sqlite");
    ran(joined({"simulate", write(folder.file("p.toml"), protocol), "--db", file}, more));
    return file;
}

/// The terminal's line of the first answered trial.
inline std::string answered_line(const std::string& out) {
    const Words lines = lines_in(out);
    const auto line = std::ranges::find_if(
        lines, [](const std::string& one) { return one.find("answered in") != std::string::npos; });
    return line == lines.end() ? "" : *line;
}

/// Words or a file are refused, and nothing is printed but why.
inline void refused(const Words& words, const std::string& why, int code = 2) {
    const Finished done = ran(words, code);
    CAPTURE(words);
    CHECK(done.out.empty());
    CHECK_THAT(done.error, Has(why));
}

}  // namespace palpate::tests
