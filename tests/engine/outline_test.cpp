#include "stimuli/two_curve.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::engine;

TEST_CASE("the turn at the vertex is 90 degrees less twice what the arcs take up", "[geometry]") {
    // Each arc turns by 2 asin(kappa c / 2) over its chord, half of it at either end.
    EACH(kappa, -20.0, -10.0, -5.0, 0.0, 5.0, 10.0, 20.0);
    const auto outline = stimuli::make_outline({.curvature = kappa});
    const double half_chord = 0.5 * std::hypot(0.040, 0.040);
    const Seam& vertex = outline->seams()[0];
    CHECK(vertex.kind == SeamKind::convex);
    CHECK(std::fabs(vertex.turn - (M_PI / 2.0 - 2.0 * std::asin(kappa * half_chord))) < 1e-14);
    CHECK(outline->seams().size() == 3);
    CHECK(outline->seams()[1].kind == SeamKind::convex);
    CHECK(outline->seams()[2].kind == SeamKind::convex);
}

TEST_CASE("seams are classified by the side to which the outline turns", "[geometry]") {
    const auto bend = [](Vec2 end) {
        return Outline({make_line({-1.0, 0.0}, {0.0, 0.0}), make_line({0.0, 0.0}, end)}, false)
            .seams()[0];
    };
    CHECK(bend({1.0, -0.5}).kind == SeamKind::convex);
    CHECK(bend({1.0, 0.5}).kind == SeamKind::concave);
    CHECK(bend({1.0, 0.0}).kind == SeamKind::smooth);
}

TEST_CASE("an outline that is not one is refused with the reason", "[geometry]") {
    CHECK_THROWS_WITH(Outline(std::vector<RationalBezier<2>>{}, false), Has("at least one"));
    CHECK_THROWS_WITH(
        Outline({make_line({0.0, 0.0}, {1.0, 0.0}), make_line({1.0, 0.1}, {2.0, 0.0})}, false),
        Has("segment 1 starts 0.1"));
    CHECK_THROWS_WITH(
        Outline({make_line({0.0, 0.0}, {1.0, 0.0}), make_line({1.0, 0.0}, {0.0, 0.0})}, false),
        Has("runs back along itself"));
    CHECK_THROWS_WITH(
        stimuli::make_outline({.a = {0.04, 0.0}, .vertex = {0.0, 0.04}, .b = {-0.04, 0.0}}),
        Has("clockwise"));
}

TEST_CASE("walking over every end of a closed outline comes back to the start", "[geometry]") {
    const auto outline = stimuli::make_outline({});
    std::size_t segment = 0;
    for (int i = 0; i < 3; ++i) {
        segment = outline->seams()[outline->seam_beyond(segment, true).value()].after;
    }
    CHECK(segment == 0);
    for (int i = 0; i < 3; ++i) {
        segment = outline->seams()[outline->seam_beyond(segment, false).value()].before;
    }
    CHECK(segment == 0);
    const Outline open({make_line({0.0, 0.0}, {1.0, 0.0})}, false);
    CHECK_FALSE(open.seam_beyond(0, true).has_value());
    CHECK_FALSE(open.seam_beyond(0, false).has_value());
}
