#include "tests/support/json_of.hpp"
#include "tests/support/page_reader.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// Four simulated people who say whether it was convex, in a file whose name is a person's code.
std::string asked_study(const TemporaryFolder& folder) {
    std::string protocol = edited(four_trials(), {{"repetitions = 1", "repetitions = 6"},
                                                  {"noise_per_m = 2.62", "noise_per_m = 6"}});
    write(folder.file("p.toml"),
          protocol +
              "\n[response]\nkind = \"yes_no\"\nquestion = \"Was it convex?\"\n"
              "confidence = true\n");
    const std::string file = folder.file("KLARA77.sqlite");
    ran({"simulate", folder.file("p.toml"), "--participants", "4", "--no-traces", "--db", file});
    return file;
}

/// In a table of the page, to four digits.
bool has_number(const std::string& html, double number) {
    const char* sign = number < 0.0 ? "\u2212" : "";
    const double size = std::fabs(number);
    return html.find(fmt::format(">{}{:.4g}<", sign, size)) != std::string::npos ||
           html.find(fmt::format(">{}{:.4f}<", sign, size)) != std::string::npos ||
           html.find(fmt::format(">{}{:.3f}<", sign, size)) != std::string::npos;
}

}  // namespace

TEST_CASE(
    "a report of yes and no has d' and criterion as palpate stats has them, and names no file") {
    const TemporaryFolder folder;
    const std::string file = asked_study(folder);
    const std::string page = folder.file("r.html");
    const Words words{"report", file, "-o", page, "--kind", "simulated", "--signal", "convex"};
    ran(words);
    const std::string html = slurp(page);
    CHECK_THAT(html, Has("id=\"sensitivity\"", "Sensitivity and criterion by friction",
                         "Share correct by friction, within person", "--json --signal convex",
                         "Is confidence worth something?",
                         "those of yes and no, with the log-linear correction (Hautus 1995)") &&
                         !Has("unbiased observer"));
    const Json numbers = json_of(
        {"stats", file, "--kind", "simulated", "--signal", "convex", "--simulations", "199"});
    CHECK_THAT(numbers.dump(), !Has("KLARA77"));
    for (const char* key : {"d_prime", "criterion"}) {
        const double mean = numbers["applied"]["measures"][key]["effects"]["on"]["mean"];
        CAPTURE(key, mean);
        CHECK(has_number(html, mean));
    }
    // The counts behind the figure are the file's own.
    const int hits = std::stoi(sql_row(
        file,
        "SELECT sum(answer_code) FROM analysis_trial WHERE counts AND planned_object = 'convex' "
        "AND phase = 'main'"));
    int counted = 0;
    for (const auto& [who, person] : numbers["applied"]["people"].items()) {
        for (const auto& [friction, cell] : person["friction"].items()) {
            counted += cell["k"].get<int>();
        }
    }
    CHECK(counted >= hits);  // right are hits and correct rejections

    // A file's name may be a code: it is on no page, and in no header, unless codes are asked for.
    CHECK_THAT(html, !Has("KLARA77"));
    for (const char* command : {"stats", "audit"}) {
        CAPTURE(command);
        CHECK_THAT(ran({command, file, "--kind", "simulated"}).out, !Has("KLARA77"));
    }
    CHECK_THAT(palpate_command({"fit", file, "--kind", "simulated"}).out, !Has("KLARA77"));
    ran(joined(words, {"--keep-codes"}));
    CHECK_THAT(slurp(page), Has("KLARA77"));

    refused(
        {"report", file, "-o", folder.file("n.html"), "--kind", "simulated", "--signal", "cube"},
        "--signal is cube: give one of");
}

TEST_CASE(
    "a report of ratings has each level's share and each person's mean, as summary has them") {
    const TemporaryFolder folder;
    std::string protocol = replaced(four_trials(), "repetitions = 1", "repetitions = 6");
    const std::string file = simulated_study(
        folder,
        protocol +
            "\n[response]\nkind = \"rating\"\nquestion = \"How convex?\"\nlevels = 5\n"
            "confidence = true\nlow = \"hollow <5>\"\nhigh = "
            "\"round\"\n\n[exclusion]\ntimed_out_share_max = 0.9\n",
        {"--participants", "5", "--no-traces"});
    ran({"mark", file, "3", "--invalid", "asked"});
    // The second person is left out by the protocol's rule.
    sql_edit(file, "UPDATE trial SET outcome = 'timed_out' WHERE session_id = 2");
    ran({"report", file, "-o", folder.file("r.html"), "--kind", "simulated"});
    const std::string html = slurp(folder.file("r.html"));
    const auto sources = sources_of(html);
    for (const char* name :
         {"simulated-levels-apart.csv", "simulated-rated.csv", "simulated-times.csv",
          "simulated-deciles.csv", "simulated-sure.csv", "simulated-learning.csv"}) {
        CAPTURE(name);
        REQUIRE(sources.contains(name));
        CHECK(sql_csv(file, sources.at(name).sql) == sources.at(name).csv);
    }
    const auto asked = [&](const std::string& sql) {
        CAPTURE(sql);
        return sql_row(file, sql);
    };
    const std::string& levels = sources.at("simulated-levels-apart.csv").sql;
    CHECK(asked("SELECT sum(n), round(sum(share), 9) FROM (" + levels + ")") ==
          asked("SELECT count(*), 4.0 FROM analysis_trial WHERE counts AND phase = 'main' AND "
                "session_id <> 2"));
    CHECK(asked("SELECT sum(n) FROM (" + levels + ") WHERE level = 5 AND friction = 'on'") ==
          asked("SELECT count(*) FROM analysis_trial WHERE counts AND answer_code = 4 AND "
                "session_id <> 2 AND friction = 'on'"));
    CHECK_THAT(html, Has("From 1 (\u201chollow &lt;5&gt;\u201d) to 5 "
                         "(\u201cround\u201d)",
                         "The question was \u201cHow convex?\u201d.",
                         "confidence was given on four levels",
                         "the tests with <code>palpate summary FILE</code> and <code>palpate "
                         "audit"));
    // Nothing is right or wrong here: confidence has its means, and no calibration.
    CHECK_FALSE(sources.contains("simulated-confidence.csv"));
    CHECK_THAT(sources.at("simulated-learning.csv").csv, Has("response_s") && !Has("share"));
    const auto of_person = [&](const char* name, const std::string& what) {
        return asked(
            fmt::format("SELECT round({}, 9) FROM ({}) WHERE friction = 'on' AND person = 3", what,
                        sources.at(name).sql));
    };
    const auto own = [&](const std::string& what) {
        return asked(fmt::format(
            "SELECT round({}, 9) FROM analysis_trial WHERE counts AND phase = 'main' AND "
            "friction = 'on' AND session_id = (SELECT session_id FROM session JOIN participant "
            "USING (participant_id) ORDER BY subject LIMIT 1 OFFSET 2)",
            what));
    };
    CHECK(of_person("simulated-sure.csv", "confidence") == own("sum(confidence) * 1.0 / count(*)"));
    CHECK(of_person("simulated-times.csv", "response_s") == own("exp(avg(ln(reaction_s)))"));

    // Means over people and differences within person: by SQL, and in the words of palpate summary.
    const std::string csv =
        of_address(behind(behind(html, "simulated-rated-results.csv", ">"), "href=\"", "\""));
    const std::string summary = palpate_command({"summary", file}).out;
    for (const std::string object : {"convex", "concave"}) {
        const std::string of = fmt::format(
            "FROM (SELECT participant_code, friction, avg(answer_code + 1) AS x FROM "
            "analysis_trial WHERE counts AND session_id <> 2 AND planned_object = '{}' GROUP BY 1, "
            "2)",
            object);
        for (const std::string friction : {"off", "on"}) {
            const std::string row = fmt::format("\n{},friction {},4,", object, friction);
            CAPTURE(csv, row);
            CHECK(std::stod(behind(csv, row)) ==
                  Approx(std::stod(
                      asked(fmt::format("SELECT avg(x) {} WHERE friction = '{}'", of, friction)))));
        }
        const Words row = split(behind(csv, fmt::format("\n{},on \u2212 off,4,", object)));
        const std::size_t begin = summary.rfind("mean level of " + object);
        const std::string counted = behind(summary.substr(begin), "on - off");
        CAPTURE(counted);
        REQUIRE(row.size() >= 4);
        for (std::size_t i = 0; i < 4; ++i) {  // mean, low, high and p
            CHECK_THAT(counted, Has(fmt::format("{:.3f}", std::stod(row[i]))));
        }
    }
}
