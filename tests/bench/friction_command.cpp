#include <iostream>

#include <fmt/ostream.h>

#include "data/plot/figure.hpp"
#include "tests/bench/commands.hpp"
#include "tests/bench/friction_runs.hpp"
#include "tests/bench/report.hpp"

namespace palpate::bench {
namespace {

constexpr const char* kWhat =
    "Laws of friction on flat ground: K 1000 N/m, load 4 N, mu 0.7 / 0.5, 1 kHz.\n"
    "jump: largest change of force in a tick, 10 mm at 0.5 Hz; 1k-10k: largest difference from "
    "the\n"
    "same stroke at 10 kHz; held: force after 1 s at rest; chatter: rms about the mean at 5 mm/s "
    "in\n"
    "steps of 10 um; drift: of 0.1 kg under 0.6 + 0.3 sin N in 18 s; given: worst balance of an\n"
    "episode in the energy ledger, 20 hands read in steps of 10 um; tick: whole contact; law: "
    "alone\n";

void print_rows(const std::vector<FrictionRow>& rows) {
    std::cout << kWhat;
    std::printf("%-22s %8s %8s %8s %8s %9s %10s %7s %7s\n", "law", "jump N", "1k-10k N", "held N",
                "chatter N", "drift mm", "given mJ", "tick ns", "law ns");
    for (const FrictionRow& row : rows) {
        std::printf("%-22s %8.3f %8.3f %8.2f %9.4f %9.3f %10.4f %7.1f %7s\n", row.law.name.c_str(),
                    row.jump, row.rate, row.held, row.chatter, 1e3 * row.drift, 1e3 * row.given,
                    row.tick,
                    row.law_alone < 0.0 ? "-" : fmt::format("{:.1f}", row.law_alone).c_str());
    }
}

void print_euler(const std::vector<EulerRun>& runs) {
    std::printf(
        "\nLuGre, sigma_0 1e4 N/m, load 2 N, after 1000 ticks at a speed: explicit Euler diverges "
        "where sigma_0 |v| T / g > 2\n%8s %8s %12s %12s\n",
        "m/s", "share", "exact N", "Euler N");
    for (const EulerRun& run : runs) {
        std::printf("%8.3f %8.2f %12.4f %12.4g\n", run.speed, run.share, run.exact, run.euler);
    }
}

void write_rows(std::ofstream& csv, const std::vector<FrictionRow>& rows) {
    csv << "machine,law,jump_n,rate_difference_n,held_n,chatter_n,drift_mm,given_mj,tick_ns,law_"
           "ns\n";
    for (const FrictionRow& row : rows) {
        fmt::print(csv, "\"{}\",{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{}\n", machine(),
                   row.law.name, row.jump, row.rate, row.held + 0.0, row.chatter, 1e3 * row.drift,
                   1e3 * row.given, row.tick > 0.0 ? fmt::format("{:.1f}", row.tick) : "",
                   row.law_alone < 0.0 ? "" : fmt::format("{:.1f}", row.law_alone));
    }
}

std::string picture_of(const std::vector<FrictionRow>& rows, const std::vector<EulerRun>& runs) {
    data::Figure figure{
        .id = "friction",
        .title = "Laws of friction: 10 mm to and fro at 0.5 Hz under 4 N, mu 0.7 / 0.5, 1 kHz",
        .columns = 4,
        .share_x = false,
        .caption =
            "Friction on the hand over its place, one stroke to and fro by our own renderer. "
            "Last: LuGre after 1 s at a speed, its exact step and explicit Euler, which "
            "diverges (cut at 1e13 N).",
        .width = 1500.0};
    for (const FrictionRow& row : rows) {
        data::Panel panel{.title = row.law.name,
                          .x = {.label = "x", .unit = "mm"},
                          .y = {.label = "F_T", .unit = "N", .low = -3.2, .high = 3.2},
                          .height = 150.0};
        data::Series& line = panel.series.emplace_back();
        line.y = row.force;
        line.ink = data::Ink::blue;
        for (const double x : row.x) {
            line.x.push_back(1e3 * x);
        }
        figure.panels.push_back(std::move(panel));
    }
    data::Panel last{.title = "LuGre: exact step and explicit Euler",
                     .x = {.label = "v", .unit = "m/s"},
                     .y = {.label = "|F|", .unit = "N", .log = true},
                     .height = 150.0};
    data::Series exact{.name = "exact", .ink = data::Ink::blue};
    data::Series euler{.name = "explicit Euler", .ink = data::Ink::vermillion};
    for (const EulerRun& run : runs) {
        exact.x.push_back(run.speed);
        exact.y.push_back(run.exact);
        euler.x.push_back(run.speed);
        euler.y.push_back(run.euler);
    }
    last.series = {std::move(exact), std::move(euler)};
    figure.panels.push_back(std::move(last));
    return data::svg(figure);
}

}  // namespace

int friction_command(Words words) {
    const std::string csv_name = words.value("--csv");
    const std::string svg_name = words.value("--svg");
    words.finish();
    Output csv(csv_name);
    Output svg(svg_name);
    std::vector<FrictionRow> rows;
    for (const RubbedLaw& law : rubbed_laws()) {
        rows.push_back(run_of(law));
    }
    const std::vector<EulerRun> runs = euler_runs();
    std::cout << machine() << '\n';
    print_rows(rows);
    print_euler(runs);
    write_rows(csv, rows);
    csv.finish();
    svg << picture_of(rows, runs);
    svg.finish();
    return 0;
}

}  // namespace palpate::bench
