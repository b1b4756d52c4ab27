#include "engine/base/sha256.hpp"
#include "tests/support/mixed_study.hpp"
#include "tests/support/program.hpp"

using namespace palpate;
using namespace palpate::tests;

namespace {

std::string page(const std::string& name) {
    return slurp(PALPATE_SOURCE_DIR "/" + name);
}

/// Every fenced block of a page in this language.
std::vector<std::string> blocks(const std::string& text, const std::string& language) {
    const std::string open = "\n```" + language + "\n";
    std::vector<std::string> found;
    for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at + 1)) {
        const std::size_t begin = at + open.size();
        found.push_back(text.substr(begin, text.find("\n```", begin) + 1 - begin));
    }
    return found;
}

}  // namespace

TEST_CASE("the example queries of docs/data.md run as printed, and answer", "[readme][law]") {
    const TemporaryFolder folder;
    const std::string file = tests::mixed_study(folder);  // with every kind of question
    const auto queries = blocks(page("docs/data.md"), "sql");
    CHECK(queries.size() >= 3);
    for (const std::string& query : queries) {
        CAPTURE(query);
        const Finished answer = Process({"sqlite3", file, query}).wait();
        CAPTURE(answer.error);
        CHECK(answer.code == 0);
        CHECK_FALSE(answer.out.empty());
    }
}

TEST_CASE("docs/data.md names every table and view of the schema", "[readme][law]") {
    const TemporaryFolder folder;
    ran({"demo", "--headless", "--db", folder.file("d.sqlite")});
    const Finished names =
        Process({"sqlite3", folder.file("d.sqlite"),
                 "SELECT name FROM sqlite_master WHERE type IN ('table', 'view')"})
            .wait();
    const std::string text = page("docs/data.md");
    for (const std::string& name : lines_in(names.out)) {
        CAPTURE(name);
        CHECK(text.find("`" + name + "`") != std::string::npos);
    }
}

TEST_CASE("uPlot lies here as its package has it, with its licence", "[docs]") {
    const std::string folder = PALPATE_SOURCE_DIR "/data/page/uplot/";
    const std::string readme = slurp(folder + "README.md");
    for (const char* name : {"uPlot.iife.min.js", "uPlot.min.css", "LICENSE"}) {
        CAPTURE(name);
        CHECK_THAT(readme,
                   Has(fmt::format("| `{}` | {} |", name, sha256_hex(slurp(folder + name)))));
    }
    CHECK_THAT(slurp(folder + "uPlot.iife.min.js"), Has("(v1.6.32)"));
    CHECK_THAT(slurp(folder + "LICENSE"), Has("The MIT License"));
}
