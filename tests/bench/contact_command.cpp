#include <iostream>

#include "tests/bench/commands.hpp"
#include "tests/bench/other_build.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/stability_limit.hpp"

namespace palpate::bench {
namespace {

/// At a terminal, what is being measured.
void show(const Place& place) {
    if (isatty(STDERR_FILENO) != 0) {
        std::cerr << "\r\033[K" << place.object << ", " << place.path << ": " << place.method
                  << (place.method.empty() ? "\r\033[K" : "") << std::flush;
    }
}

/// Counts instructions, where something does.
using Counts = std::unique_ptr<OtherBuild>;

Counts counts_of(const std::string& binary, const CoursePlan& plan, const Counting& counting) {
    return counting.by == Counting::By::nobody
             ? nullptr
             : std::make_unique<OtherBuild>(binary, plan, counting.by);
}

template <int D>
std::vector<Row> measure(Course<D>& course, Stand& stand, const Counts& counts) {
    const std::span<const Vec<D>> hips(course.hips);
    const auto truth = course.truths ? course.truths() : std::vector<Truth<D>>();
    std::vector<Row> rows;
    for (const auto& method : course.methods) {
        const Place place{course.object, course.path, method->name()};
        show(place);
        Row row{.machine = machine(),
                .object = course.object,
                .path = course.path,
                .method = method->name(),
                .kind = method->kind()};
        // A short hand is a trial of the benchmark itself, which must not wait for a quiet machine.
        const double warm = std::min(0.15, 0.05e-3 * static_cast<double>(hips.size()));
        row.time = time_of<D>(*method, hips, {.warm_seconds = warm}, stand);
        row.time.instructions = counts ? counts->instructions(place) : 0.0;
        if (row.kind != Kind::floor) {
            row.error = errors_of<D>(*method, hips, std::span<const Truth<D>>(truth));
        }
        rows.push_back(row);
    }
    show({});
    return rows;
}

/// The feedback law's stability limit, measured over formula, at the middle of every curve.
void print_stability(std::ostream& out, const CoursePlan& plan) {
    constexpr double kTick = 1e-3;
    constexpr double kAside = 0.37;  // of the curve: not where symmetry might help
    out << "\nfeedback law: largest stable gain, by bisection / 2 / (T (|f'|^2 + (f - x) . f''))\n";
    for (const Object& object : contact_objects()) {
        if (plan.objects.find(object.name) == std::string::npos) {
            continue;
        }
        for (const auto& data : object.curves) {
            const engine::NurbsCurve<2> curve(data.degree, data.knots, data.points, data.weights);
            const double u = curve.front() + kAside * (curve.back() - curve.front());
            const engine::Jet<2> jet = curve.at(u);
            const Vec2 normal = engine::perp(glm::normalize(jet.first));
            for (const double offset : {-3e-3, 0.0, 3e-3}) {
                out << object.name << ", " << 1e3 * offset << " mm: "
                    << tests::stability_limit_ratio(curve, u, jet.point + offset * normal, kTick)
                    << '\n';
            }
        }
    }
}

/// Both builds in turns, pass by pass, and who begins changes.
template <int D>
void compare(
    Course<D>& course, Stand& stand, OtherBuild& other, const Counts& here, const Counts& there) {
    constexpr int kPasses = 40;
    std::printf("\n%s, %s\n%-36s %23s %10s %8s %8s\n", course.object.c_str(), course.path.c_str(),
                "method: this build / the other", "time, 95 %", "instr.", "ns", "thrown");
    for (const auto& method : course.methods) {
        const Place place{course.object, course.path, method->name()};
        show(place);
        const std::span<const Vec<D>> hips(course.hips);
        const std::size_t rounds = rounds_of(*method, hips, stand.clock);
        Passes own;
        std::vector<std::vector<double>> ratios;
        for (int n = 0; n < kPasses; ++n) {
            std::vector<double> theirs =
                n % 2 == 0 ? other.pass(place, rounds) : std::vector<double>();
            pass(own, *method, hips, rounds, stand);
            theirs = n % 2 == 0 ? theirs : other.pass(place, rounds);
            if (theirs.size() != rounds) {
                break;
            }
            std::transform(own.ns.back().begin(), own.ns.back().end(), theirs.begin(),
                           theirs.begin(), std::divides<>());
            ratios.push_back(theirs);
        }
        show({});
        if (ratios.empty()) {
            std::printf("%-36s the other build has none\n", place.method.c_str());
            continue;
        }
        std::vector<double> weights;
        for (std::size_t i = 0; i < rounds; ++i) {
            weights.push_back(median(round_of(own.ns, i)).value);
        }
        const Median time = along(ratios, weights);
        const double instructions =
            here ? here->instructions(place) / there->instructions(place) : 0.0;
        std::printf("%-36s %7.3f [%6.3f,%6.3f] %10.4f %8.1f %4zu/%zu\n", place.method.c_str(),
                    time.value, time.low, time.high, instructions, along(own.ns).value,
                    own.thrown(), own.rounds());
        std::fflush(stdout);
    }
}

void compare(const CoursePlan& plan,
             Stand& stand,
             const Counts& here,
             const std::string& against,
             const Counting& counting) {
    OtherBuild other(against, plan, Counting::By::nobody);
    const Counts there = counts_of(against, plan, counting);
    for (const CourseMaker& maker : courses(plan)) {
        AnyCourse course = maker.make();
        std::visit([&](auto& one) { compare(one, stand, other, here, there); }, course);
    }
}

/// The picture of a table that is there already.
void draw_again(const std::string& table, const std::string& svg_name) {
    std::ifstream in(table);
    if (!in || svg_name.empty()) {
        throw WrongWord("--from takes a table of contact --csv, and needs --svg FILE beside it");
    }
    Output svg(svg_name);
    svg << picture(read_csv(in));
    svg.finish();
}

}  // namespace

int contact_command(Words words) {
    const CoursePlan plan{.objects = words.value("--objects", "ABCDES"),
                          .seconds = words.number("--seconds", 20.0, 0.1, 600.0),
                          .peers = words.flag("--peers")};
    const bool answers = words.flag("--answer");
    const std::string against = words.value("--against");
    const std::string csv_name = words.value("--csv");
    const std::string svg_name = words.value("--svg");
    const std::string table = words.value("--from");
    words.finish();
    if (!table.empty()) {
        draw_again(table, svg_name);
        return 0;
    }
    pin_to(1);
    if (answers) {
        answer_requests(plan);
        return 0;
    }
    Output csv(csv_name);
    Output svg(svg_name);
    Stand stand;
    const Counting counted = counting();
    std::cout << machine() << "; reading the clock twice takes " << stand.clock.cost()
              << " ns, which is subtracted; " << counted.sentence << '\n';
    const std::string own = std::filesystem::read_symlink("/proc/self/exe");
    const Counts counts = counts_of(own, plan, counted);
    if (!against.empty()) {
        compare(plan, stand, counts, against, counted);
        return 0;
    }
    std::vector<Row> rows;
    for (const CourseMaker& maker : courses(plan)) {
        AnyCourse course = maker.make();
        const std::vector<Row> more =
            std::visit([&](auto& one) { return measure(one, stand, counts); }, course);
        print_table(std::cout, more);
        rows.insert(rows.end(), more.begin(), more.end());
    }
    print_stability(std::cout, plan);
    write_csv(csv, rows);
    csv.finish();
    svg << picture(rows);
    svg.finish();
    return 0;
}

}  // namespace palpate::bench
