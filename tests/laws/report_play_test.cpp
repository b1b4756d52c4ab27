#include "tests/support/catch.hpp"
#include "tests/support/page_reader.hpp"
#include "tests/support/test_text.hpp"

TEST_CASE("the slider of a trial's page shows hand, god-object and force of that tick, and plays") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const std::string page = folder.file("a.html");
    ran({"run", kFourTrials, "--participant", "P1", "--db", file, "--device", "sim", "--headless"});
    ran({"report", file, "--trial", "2", "-o", page});
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
    const Browsed shown = browsed(folder, page, "--dump-dom");
    if (!shown.there) {
        WARN("Chromium is not installed: skipped");
        return;
    }
    CHECK_THAT(shown.done.error, !Has("CONSOLE"));
    const std::string stage = behind(shown.done.out, "class=\"stage\"", "</p>");
    const auto number = [&](std::size_t i) {
        return std::stod(row.at(i));
    };
    CAPTURE(stage);
    CHECK_THAT(shown.done.out,
               Has(fmt::format(
                   "data-at=\"{0:.3f} s|{0:.3f} s: disc, the hand at {1:.1f}, {2:.1f} mm; square, "
                   "god-object "
                   "{3:.1f}, {4:.1f} mm; arrow, force {5:.3f} N (10 mm is 1 N); {6}.",
                   number(1), number(2), number(3), number(4), number(5), number(6), row[7])));
    CHECK_THAT(stage, Has(">stop</button>"));
    CHECK_THAT(shown.done.out,
               Has("data-minus=\"0\"") && (Has(", 20 ticks: ") || Has(", 21 ticks: ")));
}
