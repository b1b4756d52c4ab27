#include "engine/base/sha256.hpp"
#include "tests/support/mixed_study.hpp"
#include "tests/support/program.hpp"

namespace {

std::string page(const std::string& name) {
    return slurp(PALPATE_SOURCE_DIR "/" + name);
}

}  // namespace

TEST_CASE("the example queries of docs/data.md run as printed, and answer") {
    const TemporaryFolder folder;
    const std::string file = mixed_study(folder);  // with every kind of question
    const Words queries = between(page("docs/data.md"), "\n```sql\n", "```");
    CHECK(queries.size() >= 3);
    for (const std::string& query : queries) {
        CAPTURE(query);
        const Finished answer = ended(Process({"sqlite3", file, query}).wait());
        CHECK_FALSE(answer.out.empty());
    }
}

TEST_CASE("docs/data.md names every table and view of the schema") {
    const TemporaryFile file("d.sqlite");
    ran({"demo", "--headless", "--db", file});
    const Finished names =
        Process({"sqlite3", file, "SELECT name FROM sqlite_master WHERE type IN ('table', 'view')"})
            .wait();
    const std::string text = page("docs/data.md");
    for (const std::string& name : lines_in(names.out)) {
        CAPTURE(name);
        CHECK_THAT(text, Has("`" + name + "`"));
    }
}

TEST_CASE("uPlot lies here as its package has it, with its licence") {
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
