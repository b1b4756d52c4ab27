#include "tests/bench/report.hpp"

#include <cstdarg>
#include <ostream>

namespace palpate::bench {
namespace {

/// Three digits, without an exponent where people read none.
std::string nanoseconds(double ns) {
    return printed(ns < 99.95 ? "%.1f" : "%.0f", ns);
}

std::string metres(const Row& row, double value) {
    return row.kind == Kind::floor ? "-" : printed("%.1e", value);
}

}  // namespace

std::string printed(const char* format, ...) {
    std::array<char, 512> text{};
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text.data(), text.size(), format, arguments);
    va_end(arguments);
    return text.data();
}

std::string machine() {
    std::string model = "unknown processor";
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos) {
            model = line.substr(line.find(": ") + 2);
            break;
        }
    }
    return model + ", " + std::to_string(std::thread::hardware_concurrency()) +
           " threads, " PALPATE_COMPILER;
}

void print_table(std::ostream& out, const std::vector<Row>& rows) {
    std::string heading;
    for (const Row& row : rows) {
        const std::string now = row.object + ", " + row.path;
        if (now != heading) {
            heading = now;
            out << '\n' << heading << '\n';
            out << printed("%-36s %8s %17s %8s %7s %8s %8s %8s %8s %9s %9s %9s %9s %9s %9s %8s\n",
                           "method", "x unit", "95 %", "instr.", "thrown", "ns", "p50", "p99",
                           "p99.9", "cold p50", "cold p99", "e_d p50", "e_d p99", "e_d max",
                           "foot p99", "miss %");
        }
        const Timing& t = row.time;
        out << printed("%-36s %8.3f [%7.3f,%7.3f] %8.1f %7s", row.method.c_str(), t.ratio.value,
                       t.ratio.low, t.ratio.high, t.instructions,
                       printed("%.0f/%.0f", t.thrown, t.rounds).c_str());
        for (const double ns : {t.warm, t.p50, t.p99, t.p999}) {
            out << printed(" %8s", nanoseconds(ns).c_str());
        }
        for (const double ns : {t.cold_p50, t.cold_p99}) {
            out << printed(" %9s", nanoseconds(ns).c_str());
        }
        for (const double error : {row.error.distance_p50, row.error.distance_p99,
                                   row.error.distance_max, row.error.foot_p99}) {
            out << printed(" %9s", metres(row, error).c_str());
        }
        out << printed(" %8s\n", row.kind == Kind::floor
                                     ? "-"
                                     : printed("%.2f", 100.0 * row.error.misses).c_str());
    }
}

}  // namespace palpate::bench
