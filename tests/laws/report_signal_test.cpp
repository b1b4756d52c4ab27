#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;
using tests::Finished;
using tests::palpate_command;
using tests::TemporaryFolder;
using tests::write;

namespace {

/// Four simulated people who say whether it was convex, in a file whose name is a person's code.
std::string asked_study(const TemporaryFolder& folder) {
    std::string protocol = tests::slurp(PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml");
    protocol.replace(protocol.find("repetitions = 1"), 15, "repetitions = 6");
    protocol.replace(protocol.find("noise_per_m = 2.62"), 18, "noise_per_m = 6");
    write(folder.file("p.toml"),
          protocol +
              "\n[response]\nkind = \"yes_no\"\nquestion = \"Was it convex?\"\n"
              "confidence = true\n");
    const std::string file = folder.file("KLARA77.sqlite");
    const Finished made = palpate_command(
        {"simulate", folder.file("p.toml"), "--participants", "4", "--no-traces", "--db", file});
    CAPTURE(made.error);
    REQUIRE(made.code == 0);
    return file;
}

/// In a table of the page, to four digits.
bool has_number(const std::string& html, double number) {
    return html.find(fmt::format(">{:.4g}<", number)) != std::string::npos ||
           html.find(fmt::format(">{:.4f}<", number)) != std::string::npos ||
           html.find(fmt::format(">{:.3f}<", number)) != std::string::npos;
}

}  // namespace

TEST_CASE(
    "a report of yes and no has d' and criterion as palpate stats has them, and names no file",
    "[report][stats]") {
    const TemporaryFolder folder;
    const std::string file = asked_study(folder);
    const std::string page = folder.file("r.html");
    const std::vector<std::string> words{"report", file,        "-o",       page,
                                         "--kind", "simulated", "--signal", "convex"};
    const Finished made = palpate_command(words);
    CAPTURE(made.error);
    REQUIRE(made.code == 0);
    const std::string html = tests::slurp(page);
    CHECK_THAT(html, ContainsSubstring("id=\"sensitivity\"") &&
                         ContainsSubstring("Sensitivity and criterion by friction") &&
                         ContainsSubstring("Share correct by friction, within person") &&
                         ContainsSubstring("--json --signal convex") &&
                         ContainsSubstring("Is confidence worth something?"));
    const Finished stats = palpate_command({"stats", file, "--kind", "simulated", "--signal",
                                            "convex", "--simulations", "199", "--json"});
    REQUIRE(stats.code == 0);
    const Json numbers = Json::parse(stats.out);
    CHECK(stats.out.find("KLARA77") == std::string::npos);
    for (const char* key : {"d_prime", "criterion"}) {
        const double mean = numbers["applied"]["measures"][key]["effects"]["on"]["mean"];
        CAPTURE(key, mean);
        CHECK(has_number(html, mean));
    }
    // The counts behind the figure are the file's own.
    const Finished counts = palpate_command(
        {"sql", file, "--csv", "-c",
         "SELECT sum(answer_code) FROM analysis_trial WHERE counts AND planned_object = 'convex' "
         "AND phase = 'main'"});
    const int hits = std::stoi(counts.out.substr(counts.out.find('\n') + 1));
    int told = 0;
    for (const auto& [who, person] : numbers["applied"]["people"].items()) {
        for (const auto& [friction, cell] : person["friction"].items()) {
            told += cell["k"].get<int>();
        }
    }
    CHECK(told >= hits);  // right are hits and correct rejections

    // A file's name may be a code: it is on no page, and in no header, unless codes are asked for.
    CHECK(html.find("KLARA77") == std::string::npos);
    for (const char* command : {"stats", "audit"}) {
        const Finished done = palpate_command({command, file, "--kind", "simulated"});
        CAPTURE(command);
        CHECK(done.code == 0);
        CHECK(done.out.find("KLARA77") == std::string::npos);
    }
    CHECK(palpate_command({"fit", file, "--kind", "simulated"}).out.find("KLARA77") ==
          std::string::npos);
    std::vector<std::string> named = words;
    named.emplace_back("--keep-codes");
    REQUIRE(palpate_command(named).code == 0);
    CHECK_THAT(tests::slurp(page), ContainsSubstring("KLARA77"));

    const Finished none = palpate_command(
        {"report", file, "-o", folder.file("n.html"), "--kind", "simulated", "--signal", "cube"});
    CHECK(none.code == 2);
    CHECK_THAT(none.error, ContainsSubstring("--signal is cube: give one of"));
}
