#include "tests/support/json_of.hpp"
#include "tests/support/page_reader.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"

namespace {

constexpr const char* kCode = "Quokka8";

std::string session_of(const TemporaryFolder& folder, const std::string& protocol = kFourTrials) {
    std::string file = folder.file("a.sqlite");
    const Finished done =
        palpate_command(run_words(protocol, kCode, file, {"--device", "sim", "--headless"}));
    CAPTURE(done.out, done.error);
    REQUIRE(std::filesystem::exists(file));
    return file;
}

std::string page_of_trial(const std::string& file, int trial, const Words& words = {}) {
    return page_of(file, joined({"--trial", std::to_string(trial)}, words));
}

/// Rows of a query, its head first.
std::vector<Words> ask(const std::string& file, const std::string& sql) {
    return csv_rows(sql_csv(file, sql));
}

double number(const std::string& text) {
    return text.empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(text);
}

/// What the script draws, one for each interval.
std::vector<Json> drawn_in(const std::string& page) {
    std::vector<Json> all;
    for (const std::string& ticks : between(page, "class=\"ticks\">", "</script>")) {
        all.push_back(Json::parse(ticks));
    }
    return all;
}

std::vector<double> line_of(const Json& drawn, const std::string& name) {
    Json strips = drawn["strips"];
    strips.push_back({{"lines", drawn["played"]}});
    for (const Json& strip : strips) {
        for (const Json& line : strip["lines"]) {
            if (line["name"] == name) {
                return ticks_of(line["text"], line["step"]);
            }
        }
    }
    FAIL("no line " << name);
    return {};
}

/// Every number of every tick, as the trace has it.
void check_ticks(const Json& drawn, const std::string& file, int trial, int interval, bool space) {
    std::vector<std::pair<std::string, double>> columns;
    for (const char* place : {"hip_x_m", "hip_y_m", "go_x_m", "go_y_m", "hip_z_m"}) {
        columns.emplace_back(place, 1e-6);
    }
    columns.resize(space ? 5 : 4);
    for (const char* force :
         {"rendered_normal_n", "rendered_tangential_n", "rendered_x_n", "rendered_y_n"}) {
        columns.emplace_back(force, 1e-3);
    }
    columns.insert(columns.end(), {{"lateness_us", 0.1}, {"mode", 1.0}});
    std::string sql = "SELECT time_s, hip_z_m";
    for (const auto& [name, step] : columns) {
        sql += name == "mode"          ? ", instr('free  stuck slip  transition', mode) / 6"
             : name.starts_with("go_") ? fmt::format(", iif(mode = 'free', NULL, {})", name)
                                       : ", " + name;
    }
    const auto rows = ask(file, fmt::format("{} FROM sample WHERE trial_id = {} AND interval = {}",
                                            sql, trial, interval));
    const std::vector<double> times = ticks_of(drawn["time"]["text"], drawn["time"]["step"]);
    REQUIRE(times.size() == rows.size() - 1);
    REQUIRE(drawn["ticks"] == times.size());
    double worst = 0.0;  // in steps
    std::vector<std::array<double, 4>> hand;
    for (std::size_t i = 0; i < times.size(); ++i) {
        worst = std::max(worst, std::fabs(times[i] - number(rows[i + 1][0])) / 1e-6);
        hand.push_back({number(rows[i + 1][0]), number(rows[i + 1][2]), number(rows[i + 1][3]),
                        number(rows[i + 1][1])});
    }
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const std::vector<double> values = line_of(drawn, columns[c].first);
        REQUIRE(values.size() == times.size());
        for (std::size_t i = 0; i < times.size(); ++i) {
            const double exact = number(rows[i + 1][c + 2]);
            const double off = std::fabs(values[i] - exact) / columns[c].second;
            worst = std::max(worst, std::isnan(exact) == std::isnan(values[i]) ? off : 1e9);
        }
    }
    CHECK(worst <= 0.5001);
    const std::vector<double> speed = line_of(drawn, "speed_m_per_s");
    REQUIRE(speed.size() == times.size());
    double off = 0.0;  // m/s
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (i < 20) {
            CHECK(std::isnan(speed[i]));
            continue;
        }
        const auto& [t, x, y, z] = hand[i];
        const auto& [t0, x0, y0, z0] = hand[i - 20];
        off = std::max(off, std::fabs(speed[i] - std::hypot(x - x0, y - y0, z - z0) / (t - t0)));
    }
    CHECK(off <= 0.5001e-4);
}

/// The table of what the hand did says what the view says, in its units.
void check_measures(const std::string& page, const std::string& file, int trial, int interval) {
    const auto view =
        ask(file, fmt::format("SELECT * FROM exploration WHERE trial_id = {} AND interval = {}",
                              trial, interval));
    const std::string table = behind(page, "What the hand did", "<h3");
    std::size_t looked = 0;
    const auto from = std::ranges::find(view[0], std::string("done_s"));
    for (auto c = static_cast<std::size_t>(from - view[0].begin()); c < view[0].size(); ++c) {
        std::string words = view[0][c];
        double factor = 1.0;
        for (const auto& [end, times] :
             {std::pair{"_m_per_s", 1e3}, std::pair{"_share", 1e2}, std::pair{"_m", 1e3},
              std::pair{"_s", 1.0}, std::pair{"_n", 1.0}}) {
            if (words.ends_with(end)) {
                words.resize(words.size() - std::string(end).size());
                factor = times;
                break;
            }
        }
        std::ranges::replace(words, '_', ' ');
        const std::string row = "<th scope=\"row\">" + words + "</th><td class=\"n\">";
        CAPTURE(words);
        REQUIRE_THAT(table, Has(row));
        const std::string cell = behind(table, row, "<");
        if (view[1][c].empty()) {  // as stick events without friction
            continue;
        }
        const bool minus = cell.starts_with("\u2212");
        const double value = (minus ? -1.0 : 1.0) * std::stod(minus ? cell.substr(3) : cell);
        const double exact = factor * number(view[1][c]);
        CHECK(std::fabs(value - exact) <= std::max(0.000501, 0.006 * std::fabs(exact)));
        ++looked;
    }
    CHECK(looked >= 22);  // without friction none of stick events
}

}  // namespace

TEST_CASE(
    "palpate report --trial draws a trial on one page: the view's measures, every tick of the "
    "trace, nobody's code") {
    const TemporaryFolder folder;
    const std::string file = session_of(folder);
    for (const int trial : {1, 4}) {
        const std::string page = page_of_trial(file, trial);
        CAPTURE(trial);
        check_measures(page, file, trial, 1);
        const auto drawn = drawn_in(page);
        REQUIRE(drawn.size() == 1);
        check_ticks(drawn[0], file, trial, 1, false);
        const auto view =
            ask(file, fmt::format("SELECT stick_events, felt_object, friction, done_s "
                                  "FROM exploration WHERE trial_id = {}",
                                  trial));
        const bool friction = view[1][2] == "on";  // without it nothing sticks
        CHECK((friction ? std::to_string(drawn[0]["sticks"].size()) : "") == view[1][0]);
        CHECK(ask(file, fmt::format("SELECT max(mode = 'stuck') FROM sample WHERE trial_id = {}",
                                    trial))[1][0] == (friction ? "1" : "0"));
        CHECK(count_of(page, "class=\"point\"") == drawn[0]["sticks"].size());
        CHECK_THAT(page, Has("<dd>" + view[1][1], "friction " + view[1][2] + " ("));
        REQUIRE(drawn[0]["marks"].size() == 1);
        CHECK(drawn[0]["marks"][0]["at"].get<double>() ==
              Approx(number(view[1][3]) - 0.001).margin(1e-9));
        for (const auto& [name, source] : sources_of(page)) {
            CAPTURE(name);
            CHECK(sql_csv(file, source.sql) == source.csv);
            CHECK(name.starts_with("simulated-"));
        }
        CHECK(sources_of(page).size() >= 4);
        CHECK_THAT(page, !Has(kCode));
        CHECK_THAT(page, Has("content: \"SIMULATED\"", "<strong>Simulated data.</strong>",
                             "<dt>Seal</dt><dd>holds<"));
        CHECK(page_of_trial(file, trial) == page);
        CHECK_THAT(page_of_trial(file, trial, {"--keep-codes"}), Has(kCode));
        CHECK_THAT(page, HasNone("http:", "https:", "//www", "<link", "<img", "src=", "@import",
                                 "url(h", "onload"));
        CHECK_THAT(page, Has("Permission is hereby granted"));
    }
    // Somebody changed an answer: the page says that its seal does not hold.
    sql_edit(file, "UPDATE response SET reaction_s = 0.5 WHERE trial_id = 4");
    CHECK_THAT(page_of_trial(file, 4), Has("<dt>Seal</dt><dd>does not hold"));
}

TEST_CASE("a page of a trial that faulted, has two intervals, lies in space or has no ticks") {
    const TemporaryFolder folder;
    SECTION("the force went off: cause and instant") {
        write(folder.file("p.toml"),
              short_text("shape_friction_demo",
                         {{"[safety]\n", "[safety]\nspeed_limit_m_per_s = 0.05\n"}}));
        const std::string file = session_of(folder, folder.file("p.toml"));
        const std::string page = page_of_trial(file, 1);
        const auto fault = ask(file, "SELECT max(time_s) FROM fault_tick WHERE trial_id = 1");
        const auto drawn = drawn_in(page);
        REQUIRE(drawn.size() == 1);
        CHECK(drawn[0]["marks"][0]["text"] == "force off: over_speed");
        CHECK(drawn[0]["marks"][0]["at"].get<double>() == Approx(number(fault[1][0])));
        CHECK_THAT(page, Has("<dd>over_speed<", "<dd>none<"));
        check_ticks(drawn[0], file, 1, 1, false);
    }
    SECTION("two intervals, each with its own") {
        const std::string file = simulated_study(
            folder,
            short_text("curvature_2afc", {{"explore_min_s = 2", "explore_min_s = 0.4"},
                                          {"explore_prompt_s = 10", "explore_prompt_s = 2.5"},
                                          {"explore_timeout_s = 15", "explore_timeout_s = 3"}}),
            {"--participants", "1"});
        const std::string page = page_of_trial(file, 2);
        const auto drawn = drawn_in(page);
        REQUIRE(drawn.size() == 2);
        check_ticks(drawn[0], file, 2, 1, false);
        check_ticks(drawn[1], file, 2, 2, false);
        CHECK_THAT(page, Has("Exploration, interval 2", "<dt>Felt second</dt>"));
    }
    SECTION("in space") {
        write(folder.file("p.toml"),
              short_text("patch_friction",
                         {{"repetitions = 5", "repetitions = 1"},
                          {"practice_repetitions = 1", "practice_repetitions = 0"}}));
        const std::string file = session_of(folder, folder.file("p.toml"));
        const std::string page = page_of_trial(file, 2);
        const auto drawn = drawn_in(page);
        REQUIRE(drawn.size() == 1);
        check_ticks(drawn[0], file, 2, 1, true);
        check_measures(page, file, 2, 1);
        const double share =
            number(ask(file, "SELECT covered_share FROM exploration WHERE trial_id = 2")[1][0]);
        const auto cells = static_cast<std::size_t>(std::lround(144.0 * share));
        CHECK(count_of(page, "class=\"point\"") ==
              cells + 2 * drawn[0]["sticks"].size());  // seen from above and from the front
    }
    SECTION("no ticks, and what is refused") {
        const std::string file =
            simulated_study(folder, four_trials(), {"--participants", "1", "--no-traces"});
        const std::string page = page_of_trial(file, 3);
        CHECK_THAT(page, Has("No ticks are kept of this trial") && !Has("<script"));
        check_measures(page, file, 3, 1);
        const auto refused = [&](const Words& words, const std::string& why) {
            CHECK_THAT(ran(joined({"report", file, "-o", folder.file("r.html")}, words), 2).error,
                       Has(why));
            CHECK_FALSE(std::filesystem::exists(folder.file("r.html")));
        };
        for (const auto& row : test_rows("trial_refusals.tsv")) {
            CAPTURE(row);
            refused(words_of("", row.at(0), {{"{none}", ""}}), row.at(1));
        }
        const std::string code = ask(file, "SELECT participant_code FROM participant")[1][0];
        ran({"participant", file, code, "--consent", "no"});
        refused({"--trial", "3"}, "not consenting");
    }
}

TEST_CASE("a browser draws every tick of a page of a trial, without an error or a request") {
    const TemporaryFolder folder;
    const std::string file = session_of(folder);
    static_cast<void>(page_of_trial(file, 2));
    const auto shown = browsed(folder, file + ".html");
    if (!shown) {
        return;
    }
    const std::string& page = *shown;
    CHECK(count_of(page, "<canvas") == 6);  // five strips, and where the hand is
    CHECK_THAT(page, Has("class=\"drawn\""));
    // The script's own sum of what it drew, in steps of what it was given.
    const std::string cell = behind(page, "<output", "</output>");
    const auto rows =
        ask(file,
            "SELECT count(*), max(time_s), 1000 * min(hip_x_m), 1000 * max(hip_x_m), "
            "min(rendered_normal_n), max(rendered_normal_n), min(rendered_tangential_n), "
            "max(rendered_tangential_n) FROM sample WHERE trial_id = 2");
    CHECK_THAT(cell,
               Has(fmt::format("0.000 s to {:.3f} s, {} ticks: ", number(rows[1][1]), rows[1][0])));
    std::size_t c = 2;
    for (const std::string words : {"to the right ", "normal ", "friction "}) {
        const std::string low = behind(cell, words, ";");
        CAPTURE(words, cell);
        CHECK(std::fabs(number(low) - number(rows[1][c++])) < 0.00101);
        CHECK(std::fabs(number(behind(low, " to ")) - number(rows[1][c++])) < 0.00101);
    }
}

TEST_CASE("the slider of a trial's page shows hand, god-object and force of that tick, and plays") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const std::string page = folder.file("a.html");
    ran({"report", session_of(folder), "--trial", "2", "-o", page});
    const Words row = split(sql_row(
        file,
        "SELECT tick, time_s, 1000 * hip_x_m, 1000 * hip_y_m, 1000 * go_x_m, 1000 * go_y_m, "
        "sqrt(rendered_x_n * rendered_x_n + rendered_y_n * rendered_y_n), mode FROM sample WHERE "
        "trial_id = 2 AND mode <> 'free' ORDER BY tick LIMIT 1 OFFSET 700"));
    REQUIRE(row.size() == 8);
    // A script that its policy does not name looks at the first ticks for a minus before zero,
    // moves the slider to that tick, keeps what stands there, goes as close as it can, and presses
    // play.
    write(page, replaced(slurp(page), "Content-Security-Policy", "none") +
                    replaced(test_text("scripts/play.html"), "TICK", row[0]));
    const auto shown = browsed(folder, page);
    if (!shown) {
        return;
    }
    const std::string stage = behind(*shown, "class=\"stage\"", "</p>");
    CAPTURE(stage);
    CHECK_THAT(*shown,
               Has(fmt::format(
                   "data-at=\"{0:.3f} s|{0:.3f} s: disc, the hand at {1:.1f}, {2:.1f} mm; square, "
                   "god-object "
                   "{3:.1f}, {4:.1f} mm; arrow, force {5:.3f} N (10 mm is 1 N); {6}.",
                   number(row[1]), number(row[2]), number(row[3]), number(row[4]), number(row[5]),
                   number(row[6]), row[7])));
    CHECK_THAT(stage, Has(">stop</button>"));
    CHECK_THAT(*shown, Has("data-minus=\"0\"") && (Has(", 20 ticks: ") || Has(", 21 ticks: ")));
}
