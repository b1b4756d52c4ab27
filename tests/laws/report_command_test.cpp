#include "tests/support/json_of.hpp"
#include "tests/support/page_reader.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

namespace {

/// Codes that occur in no word of the page.
const Words kCodes{"Zanzibar7", "Quokka8", "Xylem9"};

/// Three simulated people, 32 trials each with confidence; one answer is marked, one person is left
/// out by a rule.
std::string made_study(const TemporaryFolder& folder) {
    std::string protocol = edited(four_trials(), {{"repetitions = 1", "repetitions = 4"},
                                                  {"break_every = 0", "break_every = 5"}});
    write(folder.file("p.toml"), protocol +
                                     "\n[response]\nconfidence = true\n\n[exclusion]\n"
                                     "timed_out_share_max = 0.9\n");
    const std::string file = run_by(kCodes, folder.file("p.toml"), folder.file("a.sqlite"));
    ran({"mark", file, "3", "--invalid", "asked"});
    sql_edit(file, "UPDATE trial SET outcome = 'timed_out' WHERE session_id = 2");
    return file;
}

/// Looks at a.sqlite.html as a window of 1000 px and one of 390 px, a phone's, show it.
const std::string kWideAndNarrow = test_text("wide_and_narrow.html");

const Words kSimulated{"--kind", "simulated"};

/// All CSV of results, which come from no query.
std::string results_of(const std::string& page) {
    std::string text;
    for (const std::string& link : between(page, "-results", ">")) {
        text += of_address(behind(link, "href=\"", "\""));
    }
    return text;
}

std::string digits(const Json& number) {
    return fmt::format("{}", number.get<double>());
}

/// Every number of the page's results stands in the JSON of one of these commands.
/// @return how many there are
std::size_t check_results(const std::string& page, const std::vector<Words>& commands) {
    std::set<std::string> all;
    for (const Words& command : commands) {
        add_numbers(json_of(command), all);
    }
    const Words numbers = numbers_of(results_of(page));
    for (const std::string& number : numbers) {
        CAPTURE(number);
        CHECK(all.contains(number));
    }
    return numbers.size();
}

void check_structure(const std::string& page) {
    CHECK(count_of(page, "<h1>") == 1);
    int before = 0;
    std::size_t headings = 0;
    for (std::size_t at = page.find("<h"); at != std::string::npos; at = page.find("<h", at + 1)) {
        const char level = page[at + 2];
        if (level >= '1' && level <= '6') {
            CAPTURE(page.substr(at, 60));
            CHECK(level - '0' <= before + 1);
            before = level - '0';
            ++headings;
        }
    }
    CHECK(headings > 20);
    const Words figures = between(page, "<figure ", "</figure>");
    for (const std::string& figure : figures) {
        CAPTURE(figure.substr(0, 80));
        CHECK_THAT(figure, Has("<table", "<caption>", "class=\"sql\"", "class=\"csv\"", "<h3",
                               "<figcaption>"));
    }
    CHECK(figures.size() >= 10);
    CHECK(count_of(page, "<svg ") ==
          count_of(page, "role=\"img\" aria-label=") + count_of(page, "role=\"img\">\n"));
    // Nothing to fetch, nothing to run.
    CHECK_THAT(page, HasNone("http:", "https:", "//www", "<script", "<link", "<img",
                             "src=", "@import", "url(h", "file://", "onload"));
    for (const std::string& to : between(page, "href=\"", "\"")) {
        CHECK((to.starts_with("#") || to.starts_with("data:text/csv;")));
    }
    CHECK_THAT(page, Has("default-src 'none'"));
}

void check_sources(const std::string& page, const std::string& file) {
    const auto sources = sources_of(page);
    CHECK(sources.size() >= 9);
    for (const auto& [name, source] : sources) {
        CAPTURE(name);
        const std::string again = sql_csv(file, source.sql);
        CHECK(again == source.csv);
        CHECK(count_of(source.csv, "\n") > (name.find("faults") == std::string::npos ? 1U : 0U));
    }
}

/// What stands on the page is of this kind, all of it and no more.
void check_kind(const std::string& page, const std::string& kind, const std::string& file) {
    const auto rows = [&](const std::string& from) {
        return sql_first(file, "SELECT count(*) FROM " + from + " WHERE session_kind = '" + kind +
                                   "' AND phase = 'main'");
    };
    const auto sources = sources_of(page);
    const auto cells = [&](const std::string& name, const std::string& what) {
        return sql_row(
            file, "SELECT " + what + " FROM (" + sources.at(kind + "-" + name + ".csv").sql + ")");
    };
    CAPTURE(kind);
    const std::string trials = rows("analysis_trial");
    CHECK(cells("flow", "sum(attempts)") == trials);
    CHECK(cells("confusion", "sum(n_exclusions_not_applied)") == trials);
    const std::string felt = rows("(SELECT * FROM exploration WHERE counts)");
    CHECK(cells("hand", "sum(intervals)") == felt);
    const int audited =
        std::stoi(cells("audit-figure", "sum(intervals)"));  // less who is left out by a rule
    CHECK((audited > 0 && audited <= std::stoi(felt)));
    CHECK(cells("trials", "count(*)") == felt);
}

void check_numbers(const std::string& page, const std::string& file) {
    const Json all = json_of({"stats", file, "--kind", "simulated", "--simulations", "199"});
    const std::string results = results_of(page);
    REQUIRE_FALSE(all["not_applied"].is_null());
    std::size_t compared = 0;
    for (const char* part : {"applied", "not_applied"}) {
        for (const auto& [key, measure] : all[part]["measures"].items()) {
            const std::string title = measure["title"];
            CAPTURE(part, title);
            const Json& effect = measure["effects"]["on"];
            if (effect["t"].is_null()) {
                continue;
            }
            CHECK_THAT(
                results,
                Has(fmt::format("\n{},on - off,{},{},{},{},{},{},{},{},{},{},{},{}\n", title,
                                effect["people"].get<int>(), digits(effect["mean"]),
                                digits(effect["interval_95"][0]), digits(effect["interval_95"][1]),
                                digits(effect["t"]), digits(effect["df"]), digits(effect["t_p"]),
                                digits(effect["dz"]), digits(effect["sign_flip_p"]),
                                digits(effect["wilcoxon_v"]), digits(effect["wilcoxon_p"]),
                                digits(effect["bayes_factor_10"]))));
            ++compared;
        }
    }
    CHECK(compared >= 6);
    const Json& laplace = all["applied"]["mixed_model"]["on"]["laplace"];
    CHECK_THAT(page, Has("<td class=\"n\">" +
                         fmt::format("{:.3f}", laplace["no_effect"]["p"].get<double>())));

    CHECK(count_of(results, ",the same\n") ==
          count_of(ran({"audit", file, "--kind", "simulated"}).out, "the same\n"));
}

}  // namespace

TEST_CASE(
    "palpate report hands on a study as one page: figures with table, CSV and SQL that say the "
    "same, numbers of palpate stats, nobody's code") {
    const TemporaryFolder folder;
    const std::string file = made_study(folder);
    const std::string page = page_of(file, kSimulated);
    check_structure(page);
    check_sources(page, file);
    check_numbers(page, file);
    CHECK(check_results(page, {{"stats", file, "--kind", "simulated", "--simulations", "199"},
                               {"audit", file, "--kind", "simulated"}}) > 200);
    CHECK(page_of(file, kSimulated) == page);

    for (const std::string& code : kCodes) {
        CHECK_THAT(page, !Has(code));
    }
    CHECK_THAT(page,
               Has("person 1", "timed_out_share_max", "body::after { content: \"SIMULATED\"; }",
                   "<strong>Simulated data.</strong>"));
    CHECK(count_of(page, "class=\"mark\">simulated data") == count_of(page, "<svg "));
    const std::string named = page_of(file, {"--kind", "simulated", "--keep-codes"});
    for (const std::string& code : kCodes) {
        CHECK_THAT(named, Has(code));
    }

    // Another kind of sessions, be it of the same person, is another page: nothing of one is in the
    // other, but how many people that has.
    sql_edit(file,
             "UPDATE session SET session_kind = 'pilot', session_number = 2, participant_id = "
             "(SELECT "
             "participant_id FROM session WHERE session_id = 3) WHERE session_id = 1");
    const std::string pilot = page_of(file, {"--kind", "pilot"});
    CHECK_THAT(pilot,
               Has("content: \"PILOT\"", "<strong>Pilot data.</strong>", "simulated sessions: ") &&
                   !Has("imulated data"));
    check_kind(pilot, "pilot", file);
    check_kind(page_of(file, kSimulated), "simulated", file);
}

TEST_CASE("palpate report refuses what it cannot take, with value and remedy, and writes nothing") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, kFourTrials, folder.file("a.sqlite"));
    ran({"verify", file});
    const auto before = folder.names();
    for (const auto& row : test_rows("report_refusals.tsv")) {
        refused(words_of("report", row.at(0),
                         {{"{db}", file},
                          {"{page}", folder.file("r.html")},
                          {"{folder}", folder.path().string()},
                          {"{source}", PALPATE_SOURCE_DIR}}),
                row.at(1), std::stoi(row.at(2)));
        CHECK(folder.names() == before);
    }
}

TEST_CASE("a page says what was so: which device, that nobody touched, and the last tenth") {
    const TemporaryFolder folder;
    const std::string file = simulated_study(
        folder,
        edited(four_trials(), {{"explore_min_s = 0.5", "explore_min_s = 0"},
                               {"explore_prompt_s = 30", "explore_prompt_s = 0.02"},
                               {"explore_timeout_s = 45", "explore_timeout_s = 0.05"}}),
        {"--participants", "2"});
    const auto page_with = [&](const std::string& mice) {
        sql_edit(file, "UPDATE trial SET device = 'mouse' WHERE " + mice);
        return page_of(file, {"--kind", "simulated", "--bootstrap", "20", "--simulations", "20"});
    };
    const std::string handle = page_with("0");
    CHECK_THAT(handle, Has("through a handle with two degrees of freedom; the contact force was "
                           "rendered at 1 kHz",
                           "Nobody touched the object in the trials that a map would show",
                           "The 95 % band goes beyond the figure") &&
                           !Has("pointer of a mouse") && !Has("No ticks are kept"));
    const std::string tenths = sources_of(handle).at("simulated-learning.csv").csv;
    CHECK_THAT(tenths, Has("\n2,2,", "\n4,2,", "\n7,2,", "\n9,2,"));
    CHECK(count_of(tenths, "\n") == 5);
    CHECK_THAT(page_with("trial_id = 1"),
               Has("freedom, and in some trials with the pointer of a mouse, which gives no force; "
                   "the contact force was rendered"));
    CHECK_THAT(page_with("1"),
               Has("unseen objects with the pointer of a mouse, which gives no force; the "
                   "contact force was computed") &&
                   !Has("through a handle"));
}

TEST_CASE("a study with a rule is reported with psychometric functions and tracks") {
    const TemporaryFolder folder;
    write(folder.file("p.toml"),
          short_text("friction_threshold", {{"explore_min_s = 2", "explore_min_s = 0.2"},
                                            {"explore_prompt_s = 10", "explore_prompt_s = 2.5"},
                                            {"explore_timeout_s = 15", "explore_timeout_s = 3"},
                                            {"practice_trials = 4", "practice_trials = 1"},
                                            {"break_min_s = 30", "break_min_s = 0"},
                                            {"gap_s = 1", "gap_s = 0"}}) +
              "\n[invalid]\ncontact_min_s = 0\npath_min_mm = 0\n");
    const std::string file = run_by({kCodes[0]}, folder.file("p.toml"), folder.file("a.sqlite"));
    const std::string page = page_of(file, {"--kind", "simulated", "--bootstrap", "60"});
    CHECK_THAT(page, Has("id=\"curves\"", "id=\"tracks\"", "class=\"band\"", "id=\"times\""));
    CHECK_THAT(page, !Has("id=\"confusion\""));
    for (const std::string& code : kCodes) {
        CHECK_THAT(page, !Has(code));
    }
    CHECK_THAT(page, Has(">static friction coefficient</text>") && !Has(">stimulus</text>") &&
                         Has("or the board an emulator: nobody felt anything"));
    check_sources(page, file);
    CHECK_THAT(sources_of(page).at("simulated-learning.csv").csv,
               Has("response_s") && !Has("share"));
    CHECK(check_results(page, {{"fit", file, "--kind", "simulated", "--bootstrap", "60"}}) > 10);
    const std::string results = results_of(page);
    const Json fits = fitted({file, "--kind", "simulated", "--bootstrap", "60"});
    for (const Json& curve : fits["curves"]) {
        for (const char* quantity : {"threshold", "slope"}) {
            const Json& estimate = curve[quantity]["estimate"];
            CHECK_THAT(results, Has(fmt::format("{},{},", quantity[0] == 't' ? quantity : "slope b",
                                                estimate.is_number() ? digits(estimate) : "")));
        }
        CHECK_THAT(results, Has("," + digits(curve["deviance_p"]) + "\n"));
    }
}

TEST_CASE(
    "a browser opens the page of a study without an error and without a request, and a phone's "
    "cuts no caption and makes no label too small") {
    const TemporaryFolder folder;
    const std::string file = run_by({"P1"}, kFourTrials, folder.file("a.sqlite"));
    static_cast<void>(page_of(file, kSimulated));
    write(folder.file("wide_and_narrow.html"), kWideAndNarrow);
    const auto shown = browsed(folder, folder.file("wide_and_narrow.html"));
    if (!shown) {
        return;
    }
    const Json widths = Json::parse("[" + behind(*shown, "<p>[", "</p>"));
    CHECK(widths.size() == 2);
    for (const Json& of : widths) {
        CAPTURE(of.dump());
        CHECK(of["captions"] > 10);
        CHECK(of["cut"] == 0);
        CHECK(of["labels"] > 30);
        CHECK(of["smallest_px"] >= 9.0);
    }
}
