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
    return ran({command, folder.file("s.toml"), folder.file("d.csv")}).out;
}

/// What palpate sql says of a database, as CSV.
inline std::string sql_csv(const std::string& file, const std::string& query) {
    return ran({"sql", file, "--csv", "-c", query}).out;
}

/// The terminal's line of the first answered trial.
inline std::string answered_line(const std::string& out) {
    const Words lines = lines_in(out);
    const auto line = std::ranges::find_if(
        lines, [](const std::string& one) { return one.find("answered in") != std::string::npos; });
    return line == lines.end() ? "" : *line;
}

/// Words or a file are refused, and nothing is printed but why.
inline void refused(const Words& words, const std::string& why) {
    const Finished done = ran(words, 2);
    CAPTURE(words);
    CHECK(done.out.empty());
    CHECK_THAT(done.error, Has(why));
}

}  // namespace palpate::tests
