#include "ui/subject/stroke.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/dummy_window.hpp"

using namespace palpate::ui;
using palpate::engine::Vec2;

namespace {

/// Pixels covered when `corners` are drawn in white on black.
double coverage(const std::vector<Corner>& corners) {
    palpate::tests::draw_into_memory();
    Window window({.width = 640, .height = 480, .font = {}});
    window.clear({0, 0, 0});
    window.fine({0.0, 0.0}, {640.0, 480.0}, [&] { window.triangles(corners, {255, 255, 255}); });
    window.present();
    double sum = 0.0;
    const std::vector<std::uint8_t> pixels = window.pixels();
    for (std::size_t i = 0; i < pixels.size(); i += 4) {
        sum += pixels[i] / 255.0;
    }
    return sum;
}

std::vector<Vec2> ellipse(double a, double b, int points) {
    std::vector<Vec2> outline;
    for (int i = 0; i < points; ++i) {
        const double t = 2.0 * M_PI * i / points;
        outline.push_back({320.3 + a * std::cos(t), 240.6 + b * std::sin(t)});
    }
    return outline;
}

}  // namespace

// Closed form: a line of width w along a circle of radius R covers 2 pi R w.
TEST_CASE("a stroke covers its true area within 1 %", "[stroke][law]") {
    for (const double radius : {60.0, 180.0}) {
        for (const double width : {4.0, 15.0}) {
            CAPTURE(radius, width);
            const double area = 2.0 * M_PI * radius * width;
            CHECK(std::fabs(coverage(stroke(ellipse(radius, radius, 90), width)) / area - 1.0) <
                  0.01);
        }
    }
}

TEST_CASE("a straight bar covers its true area at every angle", "[stroke][law]") {
    for (int degrees = 0; degrees < 180; degrees += 35) {
        CAPTURE(degrees);
        const double t = degrees * M_PI / 180.0;
        const Vec2 along{std::cos(t), std::sin(t)};
        const Vec2 across{-along.y, along.x};
        const Vec2 middle{320.2, 240.7};
        // A closed stroke round a long rectangle: its two long sides and mitred corners.
        const std::vector<Vec2> box{
            middle - 150.0 * along - 40.0 * across, middle + 150.0 * along - 40.0 * across,
            middle + 150.0 * along + 40.0 * across, middle - 150.0 * along + 40.0 * across};
        const double width = 8.0;
        const double area = 2.0 * width * (300.0 + 80.0);
        CHECK(std::fabs(coverage(stroke(box, width)) / area - 1.0) < 0.01);
    }
}

TEST_CASE("a filled polygon covers its true area, convex or not, either way round",
          "[stroke][law]") {
    std::vector<Vec2> round = ellipse(150.0, 90.0, 120);
    CHECK(std::fabs(coverage(fill(round)) / (M_PI * 150.0 * 90.0) - 1.0) < 0.01);
    std::reverse(round.begin(), round.end());
    CHECK(std::fabs(coverage(fill(round)) / (M_PI * 150.0 * 90.0) - 1.0) < 0.01);
    const std::vector<Vec2> arrow{
        {100.0, 100.0}, {400.0, 100.0}, {250.0, 200.0}, {400.0, 300.0}, {100.0, 300.0}};
    CHECK(std::fabs(coverage(fill(arrow)) / (300.0 * 200.0 - 0.5 * 200.0 * 150.0) - 1.0) < 0.01);
}
