#include "tests/support/json_of.hpp"
#include "tests/support/page_reader.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/sql_first.hpp"

// What the page and palpate summary say of tests in words is what was tested.

namespace {

const Words kSimulated{"--kind", "simulated", "--simulations", "20"};

/// Simulated people of four trials, six times, some of whom do not feel well.
std::string simulated(const TemporaryFolder& folder,
                      const std::string& more,
                      const std::string& people) {
    write(folder.file("p.toml"),
          replaced(four_trials(), "repetitions = 1", "repetitions = 6") + more);
    write(folder.file("observer.toml"),
          "format = 1\n[hand]\nspeed_factor = 2.5\n[observer]\nnoise_per_m = 8\n[people]\n"
          "noise_sd_ln = 0.4\n[friction]\nnoise_factor_per_mu = 2\n");
    const std::string file = folder.file("a.sqlite");
    ran({"simulate", folder.file("p.toml"), "--observer", folder.file("observer.toml"),
         "--participants", people, "--no-traces", "--db", file});
    return file;
}

const std::string kStrong =
    "\n[[friction]]\nname = \"strong\"\nlaw = \"gos\"\nmu_s = 1.2\nmu_d = 1\ntau_slip_ms = 20\n"
    "tau_heal_ms = 100\n";

const std::string kAsked = "\n[response]\nkind = \"yes_no\"\nquestion = \"Was it convex?\"\n";

/// Marks the answers of the people from `first` on with a friction.
void mark_all(const std::string& file, const std::string& friction, int first) {
    sql_edit(file, fmt::format("UPDATE trial SET invalid_reason = 'bell' WHERE trial_id IN (SELECT "
                               "trial_id FROM analysis_trial WHERE friction = '{}' AND session_id "
                               ">= {})",
                               friction, first));
}

/// A study of softness, all of whose stimuli are above 0: their logarithms, or mm/N themselves.
std::string softness_study(const TemporaryFolder& folder, bool logarithms) {
    std::vector<std::pair<std::string, std::string>> edits;
    for (const auto& row : test_rows("soft_stimuli.tsv")) {
        if (row.at(0) == "log" || !logarithms) {
            edits.emplace_back(row.at(1), row.at(2));
        }
    }
    const std::string name = logarithms ? "log" : "plain";
    write(folder.file(name + ".toml"), short_text("softness_2afc", edits));
    ran({"simulate", folder.file(name + ".toml"), "--participants", "1", "--no-traces", "--db",
         folder.file(name + ".sqlite")});
    return folder.file(name + ".sqlite");
}

}  // namespace

TEST_CASE(
    "the page's headline is the protocol's primary test by its name, with the numbers of "
    "palpate stats, and all four tests stand in the flow's table") {
    const auto& [primary, title] =
        GENERATE(std::pair{"paired_t", "paired t of the share"},
                 std::pair{"sign_flip", "exact sign-flip test of the share"},
                 std::pair{"signed_rank", "Wilcoxon signed-rank test of the share"},
                 std::pair{"mixed", "likelihood ratio of the logistic mixed model"});
    const TemporaryFolder folder;
    const std::string file =
        simulated(folder, fmt::format("\n[analysis]\nprimary = \"{}\"\n", primary), "6");
    const Json part = json_of(joined({"stats", file}, kSimulated))["applied"];
    const Json& first = part["primary"]["on"];
    const std::string page = page_of(file, kSimulated);
    const std::string fact = behind(page, "<dt>on - off, primary test</dt>", "</dd>");
    CAPTURE(primary, first.dump(), fact);
    const double estimate = first["estimate"];
    CHECK_THAT(fact,
               Has(fmt::format("{}{:.3f}", estimate < 0.0 ? "\u2212" : "+", std::fabs(estimate)),
                   fmt::format("; p = {:.3f}; ", first["p"].get<double>()).substr(2), title));
    CHECK(count_of(page, ", primary test</dt>") == 1);
    CHECK_THAT(page, Has("The primary test, as the protocol says, is the " + std::string(title)));
    const Json& share = part["measures"]["share"]["effects"]["on"];
    std::string row;
    for (const Json& p : {share["t_p"], share["sign_flip_p"], share["wilcoxon_p"],
                          part["mixed_model"]["on"]["laplace"]["no_effect"]["p"]}) {
        row += fmt::format(",{}", p.get<double>());
    }
    std::string tables;
    for (const std::string& address : between(page, "href=\"data:text/csv", "\"")) {
        tables += of_address(address);
    }
    CHECK(count_of(tables, row + "\n") == 2);  // exclusions applied, and not
}

TEST_CASE("of three frictions stats, page and power say the same one to be primary") {
    const TemporaryFolder folder;
    // By name it is the last but one: what is primary follows from the friction.
    const std::string file = simulated(folder,
                                       kStrong + edited(kStrong, {{"strong", "weak"},
                                                                  {"mu_s = 1.2", "mu_s = 0.2"},
                                                                  {"mu_d = 1", "mu_d = 0.1"}}),
                                       "5");
    const std::string page = page_of(file, kSimulated);
    CHECK_THAT(page, Has("<dt>strong - off, primary test</dt>",
                         "<dt>on - off, not the primary comparison</dt>",
                         "<dt>weak - off, not the primary comparison</dt>"));
    const std::string text = ran(joined({"stats", file}, kSimulated)).out;
    CHECK_THAT(text.substr(text.find("Primary test, as"), 1000),
               Has("3 comparisons, no p corrected for the others. The primary one, as in palpate "
                   "power: strong, the largest friction."));
    CHECK_THAT(ran({"power", folder.file("p.toml"), "--effect", "-2", "--observer",
                    folder.file("observer.toml"), "--participants", "6", "--studies", "100",
                    "--hands", "1"})
                   .out,
               Has("strong against off"));
}

TEST_CASE("summary's note on sign-flips is of the people who are tested, row by row") {
    const TemporaryFolder folder;
    const std::string file = simulated(folder, kStrong, "7");
    const auto note = [&] {
        return behind(ran({"summary", file}).out, "within person", "\n\n");
    };
    CHECK_THAT(note(), Has("sign-flip: all 128 patterns of signs") && !Has("too few"));
    mark_all(file, "strong", 5);
    CHECK_THAT(note(), Has("sign-flip of 4 people: all 16 patterns of signs",
                           "sign-flip of 7 people: all 128 patterns of signs",
                           "4 people are too few to show a difference: no sign-flip p is below "
                           "0.125") &&
                           !Has("7 people are"));
    mark_all(file, "off", 6);
    CHECK_THAT(note(), Has("5 people are too few to show a difference: no sign-flip p is below "
                           "0.0625"));
}

TEST_CASE("the page names every quantity that is not the same, with the audit's verdict") {
    const TemporaryFolder folder;
    const std::string more = GENERATE(std::string(), kStrong);
    const std::string file = simulated(folder, more, "4");
    sql_edit(file, "UPDATE presentation SET start_x_m = start_x_m + 0.004 WHERE friction = 'on'");
    const Words verdicts{"DIFFERS", "differs, within bounds", "not known: more people",
                         "too few people", "the same"};
    const Words heads{"<p>DIFFERS: ", "<p>Differs, within bounds: ", "<p>Not known, more people: ",
                      "<p>Not known, too few people: "};
    const std::string page = page_of(file, kSimulated);
    std::array<std::size_t, 5> found{};
    for (const std::string& line : lines_in(ran({"audit", file, "--kind", "simulated"}).out)) {
        const auto verdict = std::ranges::find_if(
            verdicts, [&](const std::string& one) { return line.ends_with("  " + one); });
        if (verdict == verdicts.end()) {
            continue;
        }
        const auto place = static_cast<std::size_t>(verdict - verdicts.begin());
        ++found.at(place);
        const std::size_t begin = line.find_first_not_of(' ');
        const std::string title = line.substr(begin, line.find("  ", begin) - begin);
        CAPTURE(line, title);
        if (place < heads.size()) {
            CHECK_THAT(behind(page, heads.at(place), "</p>"), Has(title + " ("));
        }
    }
    CHECK(found[0] > 0);
    CHECK(found[2] > 0);
    for (std::size_t i = 0; i < heads.size(); ++i) {
        const std::string said = behind(page, heads.at(i), "</p>");
        CHECK(count_of(said, "(rig") + count_of(said, "(hand") == found.at(i));
    }
    CHECK_THAT(page, Has(more.empty() ? "start, to the right (rig)"
                                      : "start, to the right (rig, on - off)"));
}

TEST_CASE("of yes and no the page frames what the signals say, and says so of nothing else") {
    const TemporaryFolder folder;
    const std::string file = simulated(folder, kAsked, "2");
    const std::string unknown = page_of(file, kSimulated);
    CHECK_THAT(unknown, Has("No answer is right or wrong;") && !Has("class=\"right\"") &&
                            !Has("A frame marks"));
    const std::string page = page_of(file, joined(kSimulated, {"--signal", "convex"}));
    CHECK_THAT(page, Has("A frame marks the right answer;"));
    CHECK(count_of(page, "class=\"right\"") == 4);  // two objects, two frictions
    for (const std::string& row : between(page, "<tr><th scope=\"row\">conv", "</tr>")) {
        if (row.find("<td style") != std::string::npos) {
            CHECK(row.find("class=\"right\"") > row.find("<td style"));  // no, then yes
        }
    }
}

TEST_CASE("of one friction the page has no table without a row") {
    const TemporaryFolder folder;
    const std::string text = four_trials();
    const std::size_t off = text.find("[[friction]]");
    const std::size_t on = text.find("[[friction]]", off + 1);
    const std::string file = simulated_study(
        folder,
        replaced(text.substr(0, off) + text.substr(on), "repetitions = 1", "repetitions = 6"),
        {"--participants", "3", "--no-traces"});
    ran({"participant", file, "S000003", "--consent", "no"});
    const std::string page = page_of(file, kSimulated);
    CHECK_THAT(page, Has("Means over people with 95 % intervals", "3 people had a session") &&
                         !Has("<tbody>\n</tbody>") && !Has("Differences within person"));
}

TEST_CASE("the cells of a map are of one size, also where they meet the middle of the object") {
    const TemporaryFolder folder;
    const std::string file = simulated_study(
        folder,
        short_text("patch_friction", {{"repetitions = 5", "repetitions = 1"},
                                      {"practice_repetitions = 1", "practice_repetitions = 0"}}),
        {"--participants", "1"});
    const std::string map = sources_of(page_of(file, kSimulated)).at("simulated-maps.csv").csv;
    const std::string cells = sql_csv(
        file,
        "SELECT count(*) AS n FROM (SELECT DISTINCT trial_id, floor(go_x_m * 400), floor(go_y_m * "
        "400), segment FROM main_trial JOIN sample USING (trial_id) WHERE mode <> 'free')");
    CHECK(fmt::format("n\n{}\n", count_of(map, "\n") - 1) == cells);
}

TEST_CASE("a logarithm has no Weber fraction, and what a stimulus is stands beside its numbers") {
    const TemporaryFolder folder;
    const std::string log = softness_study(folder, true);
    const std::string plain = softness_study(folder, false);
    const Words how{"--kind", "simulated", "--bootstrap", "0"};
    const std::string what = "log10 of compliance in mm/N";
    CHECK(sql_csv(log, "SELECT min(stimulus) > 0 AS n FROM main_trial") == "n\n1\n");
    const Json of_log = fitted(joined({log}, how));
    CHECK(of_log["stimulus"] == what);
    CHECK(of_log["curves"][0]["weber_fraction"]["estimate"].is_null());
    CHECK(of_log["curves"][0]["weber_fraction"]["why"] == "none of a logarithmic stimulus");
    const Json of_plain = fitted(joined({plain}, how));
    CHECK(of_plain["stimulus"] == "compliance in mm/N");
    const Json& curve = of_plain["curves"][0];
    if (curve["jnd"]["estimate"].is_number()) {
        const double jnd = curve["jnd"]["estimate"];
        const double threshold = curve["threshold"]["estimate"];
        const double weber = curve["weber_fraction"]["estimate"];
        CHECK(std::fabs(weber - jnd / threshold) < 1e-9);
    }
    CHECK_THAT(ran(joined({"fit", log, "--svg", folder.file("c.svg")}, how)).out,
               Has("\n  stimulus: " + what + "\n"));
    CHECK_THAT(slurp(folder.file("c.svg")), Has(">" + what + "</text>"));
    const std::string page = page_of(log, how);
    CHECK(count_of(page, ">" + what + "</text>") == 2);  // of the curve, and of its track
    CHECK_THAT(page, Has("felt (" + what + ") by the answers so far, 12 trials",
                         "(5 1/m, which yields by 2.2 mm/N)"));
    CHECK_THAT(page_of(log, {"--trial", "1"}), Has(", " + what + "<"));
    for (const std::string format : {"quickpsy", "psignifit"}) {
        ran({"export", log, "--kind", "all", "--as", format, "-o", folder.file(format)});
        CHECK_THAT(slurp(folder.file(format + "/README.txt")),
                   Has("\nx of softness2afc: " + what + ".\n"));
    }
    const std::string both = folder.file("both.sqlite");
    ran({"merge", both, log, plain});
    CHECK_THAT(ran(joined({"fit", both, "--versions", "together"}, how), 2).error,
               Has("the versions of softness_2afc have different stimuli, compliance in mm/N and " +
                   what + ": no curve goes through both; take them apart, --versions apart"));
}

TEST_CASE("versions that are taken together keep each friction, and no curvature of one of them") {
    const TemporaryFolder folder;
    const std::string old = folder.file("old.sqlite");
    std::filesystem::rename(simulated(folder, "", "2"), old);
    write(folder.file("q.toml"),
          edited(slurp(folder.file("p.toml")), {{"curvature_per_m = 8", "curvature_per_m = 9"},
                                                {"name = \"on\"", "name = \"rough\""}}));
    ran({"simulate", folder.file("q.toml"), "--participants", "3", "--no-traces", "--db",
         folder.file("new.sqlite")});
    const std::string both = folder.file("both.sqlite");
    ran({"merge", both, old, folder.file("new.sqlite")});
    const Words how{"--kind", "simulated", "--versions", "together"};
    refused(joined({"fit", both}, how), "\"convex\" has no value to be ordered by");
    CHECK(fitted(joined({both, "--item", "convex=8.5"}, how))["values"] == Json{-8.0, 8.5});
    const std::string page = page_of(both, joined(how, {"--simulations", "20"}));
    CHECK_THAT(behind(page, "<figure id=\"times\"", "</figure>"),
               Has(">on</text>", ">rough</text>"));
}
