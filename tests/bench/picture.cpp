#include "data/plot/figure.hpp"
#include "tests/bench/report.hpp"

/// Work-precision picture: picture() of report.hpp.
namespace palpate::bench {
namespace {

constexpr double kNoError = 1e-20;  ///< shown for an error of 0

struct Style {
    Kind kind;
    data::Ink ink;
    const char* meaning;
};
constexpr std::array<Style, 5> kStyles{
    {{Kind::floor, data::Ink::grey, "no closest point: a part of any method, or a tick's force"},
     {Kind::global, data::Ink::blue, "ours, global"},
     {Kind::tracker, data::Ink::vermillion, "trackers"},
     {Kind::mesh, data::Ink::black, "polylines and meshes"},
     {Kind::peer, data::Ink::green, "libraries"}}};

const Style& style_of(Kind kind) {
    return *std::ranges::find(kStyles, kind, &Style::kind);
}

double error_of(const Row& row) {
    return std::max(row.error.distance_p99, kNoError);
}

data::Axis time_axis() {
    return {.label = "warm, a tick", .unit = "ns", .log = true};
}

/// Each row a numbered point; what has no error is a line over all errors.
data::Panel against_error(std::span<const Row> rows) {
    data::Panel panel{.x = time_axis(),
                      .y = {.label = "error of the distance, p99", .unit = "m", .log = true},
                      .height = 330.0};
    double low = 1.0;
    double high = kNoError;
    for (const Row& row : rows) {
        if (row.kind != Kind::floor) {
            low = std::min(low, error_of(row));
            high = std::max(high, error_of(row));
        }
    }
    int number = 0;
    for (const Row& row : rows) {
        const data::Ink ink = style_of(row.kind).ink;
        if (row.kind == Kind::floor) {
            panel.series.push_back({.name = row.method,
                                    .x = {row.time.warm, row.time.warm},
                                    .y = {low, high},
                                    .ink = ink,
                                    .stroke = data::Stroke::dotted});
            continue;
        }
        const std::string label = fmt::format("{}", ++number);
        panel.series.push_back({.name = fmt::format("{} {}", label, row.method),
                                .x = {row.time.warm},
                                .y = {error_of(row)},
                                .ink = ink,
                                .mark = data::Mark::points});
        panel.markers.push_back({.x = row.time.warm, .y = error_of(row), .label = label});
    }
    return panel;
}

/// Rows that only take time, by name: from the median to p99, and the mean in a loop.
data::Panel times_alone(std::span<const Row> rows) {
    data::Panel panel{
        .x = time_axis(), .y = {}, .height = 26.0 * static_cast<double>(rows.size()) + 20.0};
    panel.x.label = "warm (dot), and p50 to p99 of single ticks (line)";
    panel.y.low = 0.4;
    panel.y.high = static_cast<double>(rows.size()) + 0.6;
    double y = static_cast<double>(rows.size());
    for (const Row& row : rows) {
        panel.y.names.emplace_back(y, row.method);
        panel.series.push_back({.x = {std::max(row.time.p50, 1.0), std::max(row.time.p99, 1.0)},
                                .y = {y, y},
                                .ink = data::Ink::grey});
        panel.series.push_back({.x = {row.time.warm},
                                .y = {y},
                                .ink = style_of(row.kind).ink,
                                .mark = data::Mark::points});
        y -= 1.0;
    }
    return panel;
}

}  // namespace

std::string picture(std::span<const Row> rows) {
    data::Figure figure{.id = "contact",
                        .title = "Run time against error",
                        .columns = 2,
                        .share_x = false,
                        .caption = rows.empty() ? "" : rows.front().machine + ". Colours:",
                        .width = 1600.0};
    constexpr std::array kNames{"grey", "blue", "red", "black", "green"};
    for (std::size_t i = 0; i < kStyles.size(); ++i) {
        figure.caption += fmt::format("{} {}, {}", i == 0 ? "" : ";", kNames[i],
                                      std::string_view(kStyles[i].meaning));
    }
    for (std::size_t first = 0; first < rows.size();) {
        const auto last = std::find_if(
            rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), [&](const Row& row) {
                return row.object != rows[first].object || row.path != rows[first].path;
            });
        const std::span<const Row> group(rows.begin() + static_cast<std::ptrdiff_t>(first), last);
        const bool answers =
            std::ranges::any_of(group, [](const Row& row) { return row.kind != Kind::floor; });
        data::Panel panel = answers ? against_error(group) : times_alone(group);
        panel.title = fmt::format("{}, {}", group.front().object, group.front().path);
        figure.panels.push_back(std::move(panel));
        first += group.size();
    }
    return data::svg(figure);
}

}  // namespace palpate::bench
