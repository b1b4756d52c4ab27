#include "data/plot/figure.hpp"
#include "data/plot/object_sheet.hpp"
#include "data/plot/svg_panel.hpp"
#include "tests/figures/csv.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"
#include "tests/support/svg_reader.hpp"

using namespace palpate::data;
using namespace palpate::figures;

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

TEST_CASE("every figure is well-formed, the same twice, and its data lie inside its axes") {
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

TEST_CASE("a value that is not finite breaks the line") {
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

TEST_CASE("dense data lose points that change no pixel, never the first, the last or a peak") {
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

TEST_CASE("text is escaped, the caption is wrapped to the width, legends stand above the axes") {
    Figure figure = one_panel({0, 1}, {0, 1});
    figure.title = "mu < 1 & \"so\"";
    figure.panels[0].series[0].name = "<script>";
    for (int i = 0; i < 60; ++i) {
        figure.caption += "words of \xC2\xB5 and \xFF ";
    }
    const std::string text = svg(figure);
    CHECK_THAT(text, !Has("<script>"));
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

TEST_CASE("with equal aspect a metre is as long along x as along y") {
    Figure figure = one_panel({0.0, 0.1, 0.1, 0.0}, {0.0, 0.0, 0.02, 0.02});
    figure.panels[0].equal_aspect = true;
    const auto p = places(SvgReader(svg(figure)).all("path", "series").at(0).attributes.at("d"));
    REQUIRE(p.size() == 4);
    CHECK(std::fabs(p[1].x - p[0].x) / std::fabs(p[2].y - p[1].y) == Approx(5.0).epsilon(1e-3));
}

TEST_CASE("panels below one another share their x axis") {
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

TEST_CASE("a figure refuses what it cannot draw, with what and how to repair it") {
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
    CHECK_NOTHROW(svg(one_panel({}, {})));  // axes and "no data"
}

TEST_CASE("ticks are 1, 2 or 5 times a power of ten, inside the axis, and say their value") {
    SEEDED(random, 300U);
    const double size = random.decade(-12.0, 12.0);
    const double low = size * random.in(-3.0, 3.0);
    const AxisRange range{.low = low, .high = low + size * random.in(0.01, 5.0)};
    const AxisTicks ticks = nice_ticks(range, 6);
    REQUIRE(ticks.ticks.size() >= 2);
    CHECK(ticks.ticks.size() <= 14);
    const double step = ticks.ticks[1].at - ticks.ticks[0].at;
    const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    CHECK((std::fabs(mantissa - 1.0) < 1e-6 || std::fabs(mantissa - 2.0) < 1e-6 ||
           std::fabs(mantissa - 5.0) < 1e-6));
    for (const AxisTick& tick : ticks.ticks) {
        CHECK(range.share(tick.at) >= -1e-6);
        CHECK(range.share(tick.at) <= 1.0 + 1e-6);
        std::string label = tick.label;
        if (label.rfind("\xE2\x88\x92", 0) == 0) {
            label.replace(0, 3, "-");
        }
        CHECK(std::strtod(label.c_str(), nullptr) * std::pow(10.0, ticks.exponent) ==
              Approx(tick.at).margin(1e-6 * step));
    }
}

TEST_CASE("log axes name their decades") {
    const auto labels = [](double low, double high) {
        std::string all;
        for (const AxisTick& tick : nice_ticks({.low = low, .high = high, .log = true}, 6).ticks) {
            all += tick.label.empty() ? "" : tick.label + " ";
        }
        return all;
    };
    CHECK(labels(0.05, 2000.0) == "0.1 1 10 100 1000 ");
    CHECK(labels(1e-9, 1e-6) == "10⁻⁹ 10⁻⁸ 10⁻⁷ 10⁻⁶ ");
    CHECK(labels(1.5, 30.0) == "2 5 10 20 ");
    CHECK(labels(1.0, 4.0) == "1.0 1.5 2.0 2.5 3.0 3.5 4.0 ");
}

TEST_CASE("CSV numbers read back to the same bits") {
    Random random(11);
    CsvColumn a{.name = "time_s", .values = {}};
    CsvColumn b{.name = "a, \"b\"", .values = {}};
    for (int i = 0; i < 500; ++i) {
        a.values.push_back((random.coin() ? 1.0 : -1.0) * random.decade(-300.0, 300.0));
        b.values.push_back(i == 3 ? std::numeric_limits<double>::quiet_NaN() : i * 0.1);
    }
    const std::vector<CsvColumn> columns{a, b};
    const auto lines = lines_in(csv(columns));
    REQUIRE(lines.size() == a.values.size() + 1);
    CHECK(lines[0] == "time_s,\"a, \"\"b\"\"\"");
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const std::string& line = lines[i + 1];
        const std::size_t comma = line.find(',');
        const double x = std::strtod(line.c_str(), nullptr);
        REQUIRE(std::memcmp(&x, &a.values[i], sizeof x) == 0);
        if (std::isnan(b.values[i])) {
            REQUIRE(comma + 1 == line.size());
        } else {
            REQUIRE(std::strtod(line.c_str() + comma + 1, nullptr) == b.values[i]);
        }
    }
    CHECK(csv(std::vector<CsvColumn>{{"x", {0.1, 1e300}}}) == "x\n0.1\n1e+300\n");
    CHECK_THROWS_WITH(csv(std::vector<CsvColumn>{{"x", {1.0}}, {"y", {}}}),
                      Has("\"y\" has 0 values"));
    CHECK_THROWS_AS(csv({}), std::invalid_argument);
}

TEST_CASE("the sagitta is that of a circle through both ends of the chord") {
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const double chord = random.in(0.001, 0.1);
        const double curvature = random.in(-1.9, 1.9) / chord;
        const double s = sagitta(curvature, chord);
        // R = (c^2 / 4 + s^2) / (2 s): intersecting chords.
        CHECK_THAT(2.0 * s,
                   Catch::Matchers::WithinRel(curvature * (0.25 * chord * chord + s * s), 1e-9));
        CHECK(std::signbit(s) == std::signbit(curvature));
    }
    CHECK(sagitta(0.0, 0.05) == 0.0);
}

TEST_CASE("the sheet names every object with curvature and sagitta, and draws it to scale") {
    protocols::Protocol protocol = small_protocol();
    protocol.title = "a < b & c";
    protocol.objects.push_back({"catch_12", 12.0, false});
    const std::string svg = object_sheet(protocol, "0123456789abcdef");
    CHECK(svg == object_sheet(protocol, "0123456789abcdef"));
    const SvgReader drawing(svg);
    std::string words;
    for (const auto& element : drawing.all("text")) {
        words += element.text + '\n';
    }
    CHECK_THAT(words, Has("concave", "straight", "catch_12", "+8 1/m", "felt, not pictured",
                          "20 mm", "0123456789ab"));
    // Chord 56.57 mm, radius 125 mm: 125 - sqrt(125^2 - 28.28^2) = 3.24.
    CHECK_THAT(words, Has("sagitta +3.24 mm", "sagitta \u22123.24 mm", "sagitta 0 mm"));
}
