#pragma once

#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/slurp.hpp"

/// The program under test, asked in one line.
namespace palpate::tests {

/// palpate_command(), whose exit code must be `code`.
inline Finished ran(const std::vector<std::string>& words, int code = 0) {
    Finished done = palpate_command(words);
    CAPTURE(words, done.out, done.error);
    REQUIRE(done.code == code);
    return done;
}

/// What palpate sql says of a database, as CSV.
inline std::string sql_csv(const std::string& file, const std::string& query) {
    return ran({"sql", file, "--csv", "-c", query}).out;
}

/// Words or a file are refused, and nothing is printed but why.
inline void refused(const std::vector<std::string>& words, const std::string& why) {
    const Finished done = ran(words, 2);
    CAPTURE(words);
    CHECK(done.out.empty());
    CHECK_THAT(done.error, ContainsSubstring(why));
}

}  // namespace palpate::tests
