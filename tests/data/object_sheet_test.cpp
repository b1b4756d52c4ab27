#include "data/plot/object_sheet.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"
#include "tests/support/svg_reader.hpp"

using namespace palpate::data;

TEST_CASE("the sagitta is that of a circle through both ends of the chord", "[sheet][law]") {
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

TEST_CASE("the sheet names every object with curvature and sagitta, and draws it to scale",
          "[sheet]") {
    protocols::Protocol protocol = tests::small_protocol();
    protocol.title = "a < b & c";
    protocol.objects.push_back({"catch_12", 12.0, false});
    const std::string svg = object_sheet(protocol, "0123456789abcdef");
    CHECK(svg == object_sheet(protocol, "0123456789abcdef"));
    const tests::SvgReader drawing(svg);
    std::string words;
    for (const auto& element : drawing.all("text")) {
        words += element.text + '\n';
    }
    CHECK_THAT(words, Has("concave", "straight", "catch_12", "+8 1/m", "felt, not pictured",
                          "20 mm", "0123456789ab"));
    // Chord 56.57 mm, radius 125 mm: 125 - sqrt(125^2 - 28.28^2) = 3.24.
    CHECK_THAT(words, Has("sagitta +3.24 mm", "sagitta \u22123.24 mm", "sagitta 0 mm"));
}
