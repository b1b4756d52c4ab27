#include "data/plot/svg_figure.hpp"
#include "data/plot/svg_text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/random.hpp"
#include "tests/support/svg_reader.hpp"

using namespace palpate::data;

namespace {

struct Place {
    double x = 0.0;
    double y = 0.0;
};

/// The points of a path of M and L commands.
std::vector<Place> places(const std::string& d) {
    std::vector<Place> out;
    const char* at = d.c_str();
    while (*at == 'M' || *at == 'L') {
        char* end = nullptr;
        const double x = std::strtod(at + 1, &end);
        const double y = std::strtod(end + 1, &end);
        out.push_back({x, y});
        at = end;
    }
    return out;
}

Series random_series(Random& random, bool positive) {
    Series series{.name = "a < b & \"c\""};
    const double size = random.decade(-9.0, 9.0);
    const double middle = random.coin() ? 0.0 : size * random.in(-100.0, 100.0);
    const int n = random.below(200);
    for (int i = 0; i < n; ++i) {
        series.x.push_back(positive ? random.decade(-3.0, 3.0) : i * size);
        series.y.push_back(positive ? random.decade(-12.0, 2.0)
                                    : middle + size * random.in(-1.0, 1.0));
        if (random.below(20) == 0) {
            series.y.back() = random.coin() ? std::numeric_limits<double>::quiet_NaN()
                                            : std::numeric_limits<double>::infinity();
        }
    }
    series.mark = Mark::both;
    return series;
}

Figure random_figure(Random& random) {
    Figure figure{
        .title = "Title & <more>", .columns = 1 + random.below(3), .caption = "It's \x01 one."};
    const int panels = 1 + random.below(4);
    for (int i = 0; i < panels; ++i) {
        const bool log = random.coin();
        Panel panel{
            .title = "p", .x = {.label = "time", .unit = "s", .log = log}, .y = {.log = log}};
        panel.equal_aspect = !log && random.coin();
        for (int k = random.below(4); k > 0; --k) {
            panel.series.push_back(random_series(random, log));
        }
        if (!panel.series.empty() && !panel.series[0].x.empty()) {
            panel.markers.push_back({panel.series[0].x[0], panel.series[0].y[0], "13"});
            panel.arrows.push_back({panel.series[0].x[0], panel.series[0].y[0], 0.1, 0.2, "F"});
            panel.shades.push_back({panel.series[0].x[0], panel.series[0].x.back(), "stuck"});
        }
        figure.panels.push_back(panel);
    }
    return figure;
}

Figure one_panel(std::vector<double> x, std::vector<double> y) {
    Panel panel;
    panel.series.push_back({.name = "a", .x = std::move(x), .y = std::move(y)});
    return {.panels = {panel}};
}

}  // namespace

TEST_CASE("every figure is well-formed, the same twice, and its data lie inside its axes",
          "[report][law]") {
    SEEDED(random, 120U);
    const Figure figure = random_figure(random);
    const std::string text = svg(figure);
    CHECK(text == svg(Figure(figure)));

    const SvgReader reader(text);
    std::vector<SvgElement> plots = reader.all("rect", "plot");
    REQUIRE(plots.size() == figure.panels.size());
    std::size_t panel = 0;
    bool inside = true;
    const auto check = [&](double x, double y) {
        const SvgElement& plot = plots[panel - 1];
        inside = inside && x >= plot.number("x") && x <= plot.number("x") + plot.number("width") &&
                 y >= plot.number("y") && y <= plot.number("y") + plot.number("height");
    };
    for (const SvgElement& e : reader.elements()) {
        panel += e.is("g", "panel") ? 1U : 0U;
        if (e.is("path", "series") || e.is("path", "arrow")) {
            for (const Place& p : places(e.attributes.at("d"))) {
                check(p.x, p.y);
            }
        } else if (e.is("circle", "point") || e.is("circle", "marker")) {
            check(e.number("cx"), e.number("cy"));
        }
    }
    CHECK(inside);
    // Everything written is on the page.
    const SvgElement& page = reader.elements().front();
    for (const SvgElement& e : reader.all("text")) {
        CHECK(e.number("x") >= 0.0);
        CHECK(e.number("x") <= page.number("width"));
        CHECK(e.number("y") <= page.number("height"));
    }
}

TEST_CASE("a value that is not finite breaks the line", "[report]") {
    const SvgReader reader(
        svg(one_panel({0, 1, 2, 3, 4, 5, 6},
                      {0, 1, std::numeric_limits<double>::quiet_NaN(), 3, 2, std::nan(""), 1})));
    const std::string d = reader.all("path", "series").at(0).attributes.at("d");
    CHECK(std::count(d.begin(), d.end(), 'M') == 3);
    CHECK(std::count(d.begin(), d.end(), 'L') == 2);
    CHECK_THAT(d, Has("h0"));  // the lone last point is still a dot

    // On a log axis 0 and what is below are gaps, too.
    Figure log = one_panel({1, 2, 3, 4, 5}, {1.0, 10.0, 0.0, -5.0, 100.0});
    log.panels[0].y.log = true;
    const SvgReader second(svg(log));
    const std::string path = second.all("path", "series").at(0).attributes.at("d");
    CHECK(std::count(path.begin(), path.end(), 'M') == 2);
}

TEST_CASE("dense data lose points that change no pixel, never the first, the last or a peak",
          "[report]") {
    Figure figure = one_panel({}, {});
    for (int i = 0; i <= 100000; ++i) {
        figure.panels[0].series[0].x.push_back(i * 1e-3);
        figure.panels[0].series[0].y.push_back(i == 50000 ? 5.0 : std::sin(i * 1e-4));
    }
    const std::string text = svg(figure);
    CHECK(text.size() < 200000);
    const SvgReader reader(text);
    const SvgElement plot = reader.all("rect", "plot").at(0);
    const auto drawn = places(reader.all("path", "series").at(0).attributes.at("d"));
    const double margin = 0.04 / 1.08;  // of the range, on both sides
    CHECK(drawn.front().x == Approx(plot.number("x") + margin * plot.number("width")).margin(0.01));
    CHECK(drawn.back().x ==
          Approx(plot.number("x") + (1.0 - margin) * plot.number("width")).margin(0.01));
    const auto top = std::min_element(drawn.begin(), drawn.end(),
                                      [](const Place& a, const Place& b) { return a.y < b.y; });
    CHECK(top->y == Approx(plot.number("y") + margin * plot.number("height")).margin(0.01));
}

TEST_CASE("text is escaped, the caption is wrapped to the width, legends stand above the axes",
          "[report]") {
    Figure figure = one_panel({0, 1}, {0, 1});
    figure.title = "mu < 1 & \"so\"";
    figure.panels[0].series[0].name = "<script>";
    for (int i = 0; i < 60; ++i) {
        figure.caption += "words of \xC2\xB5 and \xFF ";
    }
    const std::string text = svg(figure);
    CHECK(text.find("<script>") == std::string::npos);
    const SvgReader reader(text);
    CHECK(reader.all("title").at(0).text == figure.title);
    const auto caption = reader.all("text", "caption");
    CHECK(caption.size() > 5);
    for (const SvgElement& line : caption) {
        CHECK(text_width(line.text, 12.0) <= figure.width - 20.0);
    }
    for (const SvgElement& e : reader.all("text")) {
        if (e.text == "<script>") {
            CHECK(e.number("y") < reader.all("rect", "plot").at(0).number("y"));
        }
    }
}

TEST_CASE("with equal aspect a metre is as long along x as along y", "[report]") {
    Figure figure = one_panel({0.0, 0.1, 0.1, 0.0}, {0.0, 0.0, 0.02, 0.02});
    figure.panels[0].equal_aspect = true;
    const auto p = places(SvgReader(svg(figure)).all("path", "series").at(0).attributes.at("d"));
    REQUIRE(p.size() == 4);
    CHECK(std::fabs(p[1].x - p[0].x) / std::fabs(p[2].y - p[1].y) == Approx(5.0).epsilon(1e-3));
}

TEST_CASE("panels below one another share their x axis", "[report]") {
    Figure figure = one_panel({0.0, 10.0}, {0.0, 1.0});
    figure.panels.push_back(one_panel({4.0, 6.0}, {0.0, 1.0}).panels[0]);
    const auto width = [](const Figure& f) {
        const auto p = places(SvgReader(svg(f)).all("path", "series").at(1).attributes.at("d"));
        return p[1].x - p[0].x;
    };
    const double shared = width(figure);
    figure.share_x = false;
    CHECK(width(figure) == Approx(5.0 * shared).epsilon(1e-3));
}

TEST_CASE("a figure refuses what it cannot draw, with what and how to repair it", "[report]") {
    CHECK_THROWS_WITH(svg(Figure{}), Has("panel"));
    CHECK_THROWS_WITH(svg(one_panel({1, 2, 3}, {1, 2})), Has("3 x and 2 y"));
    Figure figure = one_panel({0, 1}, {0, 1});
    figure.panels[0].y.low = 5.0;
    CHECK_THROWS_WITH(svg(figure), Has("goes from 5"));
    figure = one_panel({1, 2}, {1, 2});
    figure.panels[0].x = {.label = "f", .log = true, .low = -1.0};
    CHECK_THROWS_WITH(svg(figure), Has("\"f\"", "above 0"));
    figure = one_panel({1, 2}, {1, 2});
    figure.columns = 0;
    CHECK_THROWS_WITH(svg(figure), Has("0 columns"));
    figure = one_panel({1, 2}, {1, 2});
    figure.width = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(svg(figure), Has("nan px wide"));
    CHECK_THROWS_WITH(write_svg("/nowhere/at/all.svg", one_panel({1}, {1})),
                      Has("/nowhere/at/all.svg"));
    CHECK_NOTHROW(svg(one_panel({}, {})));  // axes and "no data"
}
