#include <iostream>

#include "engine/safety/passivity.hpp"
#include "tests/bench/commands.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/counted_wall.hpp"

namespace palpate::bench {
namespace {

constexpr std::array<double, 4> kRates{1000.0, 2000.0, 4000.0, 10000.0};
constexpr std::array<double, 2> kDampings{0.25, 0.5};
constexpr double kSeconds = 4.0;  ///< of simulated time for each stiffness tried
constexpr int kHalvings = 18;     ///< 0.2 / 2^18 of the bound: 1e-6

struct Boundary {
    tests::SampledWall scalar{};
    double measured = 0.0;  ///< N/m
    double exact = 0.0;
    double formula = 0.0;
};

Boundary row_of(double rate, double damping, int delay) {
    const tests::DeviceWall wall = tests::fine_wall(damping, 1.0 / rate, delay);
    Boundary row;
    row.scalar = tests::scalar_of(wall);
    row.measured = tests::device_stiffness(wall, static_cast<int>(kSeconds * rate), kHalvings);
    row.exact = tests::exact_stiffness(row.scalar);
    row.formula = tests::passive_stiffness(row.scalar);
    return row;
}

double percent(double measured, double expected) {
    return 100.0 * (measured / expected - 1.0);
}

/// With counts that show: the dry friction that lets it rest, and how it creeps without.
void print_rest() {
    std::printf(
        "\nThe same wall, 1000 N/m, read in counts: how it creeps on without dry friction, against "
        "(K e - f) / (b - K T (1/2 + delay)),\nand the least dry friction with which it rests, "
        "bisected, against K e; e: the most that a reading is off.\n%7s %6s %7s %7s %7s %10s %10s "
        "%10s %10s\n",
        "Hz", "delay", "b/need", "counts", "e um", "mm/s", "at most", "mN", "K e mN");
    for (const double rate : {1000.0, 4000.0}) {
        for (const int delay : {0, 1}) {
            for (const double share : {1.2, 2.0, 4.0}) {
                for (const double counts : {4096.0, 16384.0, 65536.0}) {
                    tests::CountedWall wall{
                        .period = 1.0 / rate, .delay = delay, .counts_per_turn = counts};
                    const double need = engine::min_damping(wall.stiffness, wall.period, delay);
                    wall.damping = share * need;
                    const tests::CountedRest loose = tests::let_go(wall, 6.0);
                    const double resting =
                        engine::resting_friction(wall.stiffness, wall.period, loose.reading_error);
                    std::printf("%7.0f %6d %7.1f %7.0f %7.2f %10.3f %10.3f %10.3f %10.3f\n", rate,
                                delay, share, counts, 1e6 * loose.reading_error, 1e3 * loose.speed,
                                1e3 * engine::creep_limit(resting, 0.0, wall.damping - need),
                                1e3 * tests::least_friction(wall, 2.0 * resting, 9), 1e3 * resting);
                }
            }
        }
    }
}

}  // namespace

int passivity_command(Words words) {
    const std::string csv_name = words.value("--csv");
    words.finish();
    Output csv(csv_name,
               "machine,rate_hz,delay_ticks,damping_n_s_per_m,mass_kg,measured_n_per_m,"
               "exact_n_per_m,formula_n_per_m\n");
    std::cout << machine() << '\n'
              << "The stiffest flat wall on which the simulated pantograph comes to rest, "
                 "bisected, against the\nexact limit of a sampled mass and damper, and against K = "
                 "b / (T (1/2 + delay)).\n";
    std::printf("%7s %6s %9s %7s %12s %12s %12s %11s %13s\n", "Hz", "delay", "b N s/m", "kg",
                "measured", "exact", "formula", "to exact %", "to formula %");
    double worst_exact = 0.0;
    double worst_formula = 0.0;
    for (const double rate : kRates) {
        for (const int delay : {0, 1}) {
            for (const double damping : kDampings) {
                const Boundary row = row_of(rate, damping, delay);
                const double to_exact = percent(row.measured, row.exact);
                const double to_formula = percent(row.measured, row.formula);
                worst_exact = std::fmax(worst_exact, std::fabs(to_exact));
                worst_formula = std::fmax(worst_formula, std::fabs(to_formula));
                std::printf("%7.0f %6d %9.3f %7.4f %12.4f %12.4f %12.4f %+11.4f %+13.4f\n", rate,
                            delay, row.scalar.damping, row.scalar.mass, row.measured, row.exact,
                            row.formula, to_exact, to_formula);
                csv << printed("\"%s\",%.0f,%d,%.9g,%.9g,%.9g,%.9g,%.9g\n", machine().c_str(), rate,
                               delay, row.scalar.damping, row.scalar.mass, row.measured, row.exact,
                               row.formula);
            }
        }
    }
    std::printf("worst deviation: %.4f %% from the exact limit, %.4f %% from the formula\n",
                worst_exact, worst_formula);
    print_rest();
    csv.finish();
    return 0;
}

}  // namespace palpate::bench
