#include <fstream>
#include <iostream>

#include <unistd.h>

#include "tests/bench/commands.hpp"
#include "tests/bench/errors.hpp"
#include "tests/bench/hand.hpp"
#include "tests/bench/own_methods.hpp"
#include "tests/bench/peers/peers.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/surfaces.hpp"
#include "tests/support/stability_limit.hpp"

namespace palpate::bench {
namespace {

constexpr const char* kContactUsage =
    "contact takes --peers, --objects LETTERS, --seconds S, --csv FILE and --svg FILE, or --from "
    "FILE "
    "and --svg FILE";

struct Path {
    std::string name;
    double nearest = 0.0;
    double farthest = 0.0;
};

double seconds_of(const std::string& text) {
    std::size_t used = 0;
    double seconds = 0.0;
    try {
        seconds = std::stod(text, &used);
    } catch (const std::exception&) {
        used = 0;
    }
    if (used != text.size() || !(seconds >= 0.1 && seconds <= 600.0)) {
        throw WrongWord("--seconds is " + text + ": give 0.1 to 600");
    }
    return seconds;
}

template <int D>
void measure(std::vector<Row>& rows,
             const std::string& object,
             const std::string& path_name,
             const Methods<D>& methods,
             const std::vector<Vec<D>>& path,
             const std::vector<Truth<D>>& truth,
             const Clock& clock) {
    const std::span<const Vec<D>> hips(path);
    const bool watched = isatty(STDERR_FILENO) != 0;
    for (const auto& method : methods) {
        if (watched) {
            std::cerr << "\r\033[K" << object << ", " << path_name << ": " << method->name()
                      << std::flush;
        }
        Row row{.machine = machine(),
                .object = object,
                .path = path_name,
                .method = method->name(),
                .kind = method->kind()};
        row.time = time_of<D>(*method, hips, {}, clock);
        if (row.kind != Kind::floor) {
            row.error = errors_of<D>(*method, hips, std::span<const Truth<D>>(truth));
        }
        rows.push_back(row);
    }
    if (watched) {
        std::cerr << "\r\033[K" << std::flush;
    }
}

template <int D>
void append(Methods<D>& all, Methods<D> more) {
    for (auto& method : more) {
        all.push_back(std::move(method));
    }
}

/// The feedback law's stability limit, measured over formula, at the middle of every curve.
void print_stability(std::ostream& out, const std::vector<Object>& objects) {
    constexpr double kTick = 1e-3;
    constexpr double kAside = 0.37;  // of the curve: not where symmetry might help
    out << "\nfeedback law: largest stable gain, by bisection / 2 / (T (|f'|^2 + (f - x) . f''))\n";
    for (const Object& object : objects) {
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

/// The picture of a table that is there already.
void draw_again(const std::string& table, const std::string& svg_name) {
    std::ifstream in(table);
    if (!in || svg_name.empty()) {
        throw WrongWord("--from takes a table of contact --csv, and needs --svg FILE beside it");
    }
    std::ofstream svg = open_output(svg_name);
    svg << picture(read_csv(in));
    close_output(svg, svg_name);
}

}  // namespace

int contact_command(const std::vector<std::string>& arguments) {
    Words words(arguments);
    const bool with_peers = words.flag("--peers");
    const double seconds = seconds_of(words.value("--seconds", "20"));
    const std::string wanted = words.value("--objects", "ABCDES");
    const std::string csv_name = words.value("--csv");
    const std::string svg_name = words.value("--svg");
    const std::string table = words.value("--from");
    words.finish(kContactUsage);
    if (!table.empty()) {
        draw_again(table, svg_name);
        return 0;
    }
    need_peers_if(with_peers);
    std::ofstream csv = open_output(csv_name);
    std::ofstream svg = open_output(svg_name);

    const Clock clock;
    std::cout << machine() << "; reading the clock twice takes " << clock.cost()
              << " ns, which is subtracted\n";
    std::vector<Row> rows;
    std::vector<Object> objects = contact_objects();
    std::erase_if(objects,
                  [&](const Object& o) { return wanted.find(o.name) == std::string::npos; });
    for (const Object& object : objects) {
        std::vector<Path> paths{{"-3..+3 mm", -3e-3, 3e-3}};
        if (object.name == "D") {
            paths.push_back({"0..+3 mm", 0.0, 3e-3});
        }
        for (const Path& path : paths) {
            const std::vector<Vec2> hips = hand_along(
                object, {.seconds = seconds, .nearest = path.nearest, .farthest = path.farthest});
            Methods<2> methods = own_methods(object);
            if (with_peers) {
                append(methods, peer_methods(object));
            }
            append(methods, soft_methods(object));
            const std::size_t before = rows.size();
            measure<2>(rows, object.name, path.name, methods, hips, truths(object, hips), clock);
            print_table(std::cout,
                        {rows.begin() + static_cast<std::ptrdiff_t>(before), rows.end()});
        }
    }
    for (const Object& object : objects) {
        const std::vector<Vec2> hips =
            hand_along(object, {.seconds = seconds, .nearest = -3e-3, .farthest = -5e-4});
        const std::size_t before = rows.size();
        Methods<2> methods = tick_methods(object);
        append(methods, soft_methods(object));
        measure<2>(rows, object.name, "ticks, -3..-0.5 mm", methods, hips, {}, clock);
        print_table(std::cout, {rows.begin() + static_cast<std::ptrdiff_t>(before), rows.end()});
    }
    const bool in_space = wanted.find('S') != std::string::npos;
    for (const Surface& surface : in_space ? contact_surfaces() : std::vector<Surface>()) {
        Methods<3> methods = own_surface_methods(surface);
        if (with_peers) {
            append(methods, peer_surface_methods(surface));
        }
        if (methods.empty()) {
            continue;
        }
        const std::vector<Vec3> hips = hand_over(surface, 0.2 * seconds);
        const std::size_t before = rows.size();
        measure<3>(rows, surface.name, "-3..+3 mm", methods, hips, truths(surface, hips), clock);
        print_table(std::cout, {rows.begin() + static_cast<std::ptrdiff_t>(before), rows.end()});
    }
    print_stability(std::cout, objects);
    if (csv.is_open()) {
        write_csv(csv, rows);
        close_output(csv, csv_name);
    }
    if (svg.is_open()) {
        svg << picture(rows);
        close_output(svg, svg_name);
    }
    return 0;
}

}  // namespace palpate::bench
