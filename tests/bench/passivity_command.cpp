#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "tests/bench/commands.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/device_wall.hpp"

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

}  // namespace

int passivity_command(const std::vector<std::string>& arguments) {
    Words words(arguments);
    const std::string csv_name = words.value("--csv");
    words.finish("passivity takes --csv FILE");
    std::ofstream csv = open_output(csv_name);
    if (csv.is_open()) {
        csv << "machine,rate_hz,delay_ticks,damping_n_s_per_m,mass_kg,measured_n_per_m,"
               "exact_n_per_m,formula_n_per_m\n";
    }
    std::cout
        << machine() << '\n'
        << "The stiffest flat wall on which the simulated pantograph comes to rest, bisected, "
           "against the\nexact limit of a sampled mass and damper, and against "
           "K = b / (T (1/2 + delay)).\n";
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
                if (csv.is_open()) {
                    std::array<char, 256> line{};
                    std::snprintf(line.data(), line.size(),
                                  "\"%s\",%.0f,%d,%.9g,%.9g,%.9g,%.9g,%.9g\n", machine().c_str(),
                                  rate, delay, row.scalar.damping, row.scalar.mass, row.measured,
                                  row.exact, row.formula);
                    csv << line.data();
                }
            }
        }
    }
    std::printf("worst deviation: %.4f %% from the exact limit, %.4f %% from the formula\n",
                worst_exact, worst_formula);
    if (csv.is_open()) {
        close_output(csv, csv_name);
    }
    return 0;
}

}  // namespace palpate::bench
