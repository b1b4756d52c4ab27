#include "protocols/design/object_outline.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/trial/object_hash.hpp"
#include "tests/support/frame.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::protocols;
using engine::Vec2;

namespace {

const std::string kFreeForms = slurp(PALPATE_SOURCE_DIR "/tests/golden/free_forms.toml");

/// The default study with other [[object]] tables.
std::string with_objects(const std::string& objects) {
    const std::string text = short_text("shape_friction");
    const std::size_t from = text.find("[[object]]");
    const std::size_t to = text.find("[[friction]]");
    return text.substr(0, from) + objects + text.substr(to);
}

Protocol free_forms() {
    return parse_protocol(kFreeForms, "f.toml");
}

double distance_to(const std::vector<Vec2>& polyline, const Vec2& p) {
    double least = 1e9;
    for (std::size_t i = 0; i < polyline.size(); ++i) {
        const Vec2 from = polyline[i];
        const Vec2 along = polyline[(i + 1) % polyline.size()] - from;
        const double u = std::clamp(glm::dot(p - from, along) / glm::dot(along, along), 0.0, 1.0);
        least = std::min(least, glm::length(p - from - u * along));
    }
    return least;
}

/// Ticks of a finger that presses `depth` deep all along an object, by a spring of the study's
/// stiffness.
std::vector<engine::TickRecord> felt(const Protocol& protocol, std::size_t object, double depth) {
    std::vector<engine::TickRecord> ticks;
    const auto outline = outline_of(protocol, object);
    for (const auto& span : outline->spans()) {
        for (int i = 1; i < 400; ++i) {
            const engine::Frame frame = engine::frame_at(span, i / 400.0);
            engine::TickRecord tick;
            tick.mode = engine::Mode::slip;
            tick.hip = engine::Vec3(frame.point - depth * frame.normal, 0.0);
            tick.force = engine::Vec3(protocol.apparatus.stiffness * depth * frame.normal, 0.0);
            tick.normal_force = glm::length(tick.force);
            ticks.push_back(tick);
        }
    }
    return ticks;
}

}  // namespace

TEST_CASE("a set stands for its objects: the study's hash is that of the objects written out") {
    const std::string sets =
        with_objects("[[object]]\nset = \"five_shapes\"\n\n[[object]]\nset = \"catch_pair\"\n\n");
    const Protocol study = parse_protocol(sets, "p.toml");
    const Protocol written = parse_protocol(short_text("shape_friction"), "p.toml");
    CHECK(study == written);
    CHECK(protocol_hash(study) == protocol_hash(written));
}

TEST_CASE("a ladder of curvatures is even, exact at its ends, and named by them") {
    Random random(3);
    for (int i = 0; i < 50; ++i) {
        const double from = random.in(-15.0, 0.0);
        const double to = random.in(1.0, 15.0);
        const int count = 2 + random.below(8);
        const Protocol study = parse_protocol(
            with_objects(fmt::format("[[object]]\nset = \"curvature_ladder\"\nfrom_per_m = {}\n"
                                     "to_per_m = {}\ncount = {}\nprefix = "
                                     "\"l_\"\n\n[[object]]\nset = \"catch_pair\"\n\n",
                                     from, to, count)),
            "p.toml");
        REQUIRE(study.objects.size() == static_cast<std::size_t>(count) + 2);
        CHECK(study.objects.front().curvature == from);
        CHECK(study.objects[static_cast<std::size_t>(count) - 1].curvature == to);
        for (int k = 1; k + 1 < count; ++k) {
            CHECK(std::fabs(study.objects[static_cast<std::size_t>(k)].curvature -
                            (from + (to - from) * k / (count - 1))) < 1e-12);
        }
        CHECK(study.objects[static_cast<std::size_t>(count)].name == "concave_20");
        CHECK_FALSE(study.objects.back().pictured);
        CHECK(study.objects.front().name.starts_with(from < 0.0 ? "l_concave_" : "l_"));
    }
}

TEST_CASE("the canonical text of free forms is explicit and reads back as the same study") {
    const Protocol study = free_forms();
    REQUIRE(study.objects.size() == 6);
    const std::string text = to_toml(study);
    CAPTURE(text);
    CHECK(text.find("set =") == std::string::npos);
    CHECK(text.find("[[object.segment]]") != std::string::npos);
    CHECK(parse_protocol(text, "again.toml") == study);
    CHECK(to_toml(parse_protocol(text, "again.toml")) == text);
    CHECK_FALSE(curvature_of(study.objects[0]));
    CHECK(curvature_of(study.objects[2]).value() == -7.5 / 0.9);
    CHECK_FALSE(differ_in_curvature_alone(study));
}

TEST_CASE(
    "two arcs and a base line from control points are the object of that curvature, to the bit") {
    const double curvature = GENERATE(-10.0, -5.0, 0.0, 5.0, 10.0, 20.0);
    Protocol study;
    study.objects = {{.name = "curves", .curvature = curvature}, {.name = "free"}};
    using Kind = stimuli::Segment::Kind;
    const auto& [a, v, b] = study.outline;
    study.objects[1].segments = {{.kind = Kind::arc, .points = {a, v}, .curvature = curvature},
                                 {.kind = Kind::arc, .points = {v, b}, .curvature = curvature},
                                 {.kind = Kind::line, .points = {b, a}}};
    CHECK(outline_text(*outline_of(study, 0)) == outline_text(*outline_of(study, 1)));
    for (ObjectSpec& object : study.objects) {
        object.size = 1.7;
        object.turn = 0.3;
        object.offset = {0.01, -0.02};
    }
    CHECK(outline_text(*outline_of(study, 0)) == outline_text(*outline_of(study, 1)));
}

TEST_CASE("a placed object is the object enlarged, then turned, then moved") {
    SEEDED(random, std::uint64_t{40});
    Protocol study = free_forms();
    const Protocol before = study;
    const double size = random.in(0.2, 3.0);
    const double turn = random.in(-3.0, 3.0);
    const Vec2 offset{random.in(-0.1, 0.1), random.in(-0.1, 0.1)};
    for (std::size_t i = 0; i < 2; ++i) {
        study.objects[i].size = size;
        study.objects[i].turn = turn;
        study.objects[i].offset = offset;
        const auto placed = outline_of(study, i);
        const auto plain = outline_of(before, i);
        REQUIRE(placed->spans().size() == plain->spans().size());
        for (std::size_t k = 0; k < plain->spans().size(); ++k) {
            const Vec2 p = plain->spans()[k].at(0.37).point;
            const Vec2 expected{size * (std::cos(turn) * p.x - std::sin(turn) * p.y) + offset.x,
                                size * (std::sin(turn) * p.x + std::cos(turn) * p.y) + offset.y};
            CHECK(glm::length(placed->spans()[k].at(0.37).point - expected) < 1e-15);
        }
    }
}

TEST_CASE("the picture of a free form is nowhere farther from its outline than it says") {
    const Protocol study = free_forms();
    const double tolerance = GENERATE(20e-6, 200e-6, 2e-3);
    for (std::size_t i = 0; i < study.objects.size(); ++i) {
        const auto outline = outline_of(study, i);
        const std::vector<Vec2> picture = stimuli::silhouette(*outline, tolerance);
        CHECK(picture.size() < 600);
        const engine::OutlineFeet feet(*outline);
        for (const Vec2& corner : picture) {
            CHECK(feet.closest(corner).distance < 1e-12);
        }
        for (const auto& span : outline->spans()) {
            for (int k = 0; k <= 200; ++k) {
                CHECK(distance_to(picture, span.at(k / 200.0).point) <= tolerance + 1e-12);
            }
        }
    }
}

// Corners on a grid of integers: whether two edges meet is decided there without rounding.
TEST_CASE("a polygon that meets itself is found, and no other") {
    int met = 0;
    for (std::uint64_t seed = 0; seed < 4000; ++seed) {
        Random random(seed);
        const int n = 4 + random.below(5);
        std::vector<std::pair<int, int>> grid;
        std::vector<Vec2> polygon;
        for (int i = 0; i < n; ++i) {
            std::pair<int, int> corner;
            do {
                corner = {random.below(12), random.below(12)};
            } while (std::find(grid.begin(), grid.end(), corner) != grid.end());
            grid.push_back(corner);
            polygon.push_back(Vec2{corner.first, corner.second});
        }
        const auto at = [&](int i) {
            return grid[static_cast<std::size_t>(i % n)];
        };
        const auto turn = [](auto p, auto q, auto r) {
            const int area = (q.first - p.first) * (r.second - p.second) -
                             (q.second - p.second) * (r.first - p.first);
            return (area > 0) - (area < 0);
        };
        const auto between = [](auto p, auto q, auto r) {
            return std::min(p.first, q.first) <= r.first && r.first <= std::max(p.first, q.first) &&
                   std::min(p.second, q.second) <= r.second &&
                   r.second <= std::max(p.second, q.second);
        };
        bool meets = false;
        for (int i = 0; i < n; ++i) {
            for (int k = i + 2; k < n && !(i == 0 && k == n - 1); ++k) {
                const auto a = at(i), b = at(i + 1), c = at(k), d = at(k + 1);
                meets = meets ||
                        (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) ||
                        (turn(a, b, c) == 0 && between(a, b, c)) ||
                        (turn(a, b, d) == 0 && between(a, b, d)) ||
                        (turn(c, d, a) == 0 && between(c, d, a)) ||
                        (turn(c, d, b) == 0 && between(c, d, b));
            }
        }
        CAPTURE(seed);
        CHECK(stimuli::self_crossing(polygon).has_value() == meets);
        met += meets ? 1 : 0;
    }
    CHECK(met > 1000);
    CHECK(met < 3500);
}

TEST_CASE("an object that cannot be is refused at its place") {
    for (const auto& row : test_rows("free_form_problems.tsv")) {
        CAPTURE(row);
        const std::string said = refusal(replaced(kFreeForms, row.at(0), row.at(1)));
        CHECK_THAT(said, Has(row.at(2)));
        CHECK(said.starts_with("p.toml:"));
    }
    CHECK_THAT(
        refusal(with_objects("[[object]]\nname = \"a\"\n\n[[object]]\nset = \"five_shapes\"\n\n")),
        Has("[[object]] 1 lacks the key curvature_per_m"));
}

TEST_CASE("two pictured free forms of one outline are refused") {
    const std::string& text = kFreeForms;
    const std::size_t from = text.find("[[object]]");
    const std::size_t to = text.find("[[object]]", from + 1);
    std::string copy = replaced(text.substr(from, to - from), "dome", "dome_2");
    CHECK_THAT(refusal(text.substr(0, to) + copy + text.substr(to)),
               Has("has the outline of [[object]] 1"));
}

TEST_CASE("an observer without noise knows each form by touch, wherever its picture stands") {
    Protocol study = free_forms();
    study.observer = {.noise = 0.0, .lapse = 0.0};
    SEEDED(random, std::uint64_t{12});
    std::vector<std::size_t> order{0, 1, 2, 3};
    for (std::size_t i = 3; i > 0; --i) {
        std::swap(order[i], order[random.index(i + 1)]);
    }
    const auto place = random.index(4);
    const double depth = random.in(0.0005, 0.003);
    SimulatedObserver observer(study, {.protocol_hash = "h", .participant = "p", .purpose = {}},
                               order, [] { return true; });
    auto ticks = felt(study, order[place], depth);
    observer.feel(ticks);
    const std::vector<Picture> pictures(4);
    CHECK(observer.choose({}, which_of(pictures)).place == place);
    Question sure = which_of(pictures);
    sure.confidence = true;
    CHECK(observer.choose({}, sure).confidence.value_or(0) >= 1);
    sure.kind = ResponseKind::yes_no;  // what no picture answers is a guess, not a picture's place
    sure.answers = 2;
    CHECK(observer.choose({}, sure).place < 2);
    OutlineCues cues(study, order);
    cues.add(ticks);
    CHECK(cues.misfits()[place] < 1e-9);

    // What the ticks say of the truth is not read.
    for (engine::TickRecord& tick : ticks) {
        tick.cp = tick.go = engine::Vec3{random.in(-1.0, 1.0), random.in(-1.0, 1.0), 0.0};
        tick.u = random.in(0.0, 1.0);
        tick.segment = static_cast<std::int16_t>(random.below(4));
    }
    OutlineCues again(study, order);
    again.add(ticks);
    CHECK(again.misfits() == cues.misfits());
}

TEST_CASE("an observer of forms who felt nothing, or only noise, guesses evenly") {
    Protocol study = free_forms();
    study.observer = {.noise = 1e6, .lapse = 0.0};
    const bool touched = GENERATE(false, true);
    const auto ticks = felt(study, 0, 0.001);
    const std::vector<Picture> pictures(4);
    std::vector<int> chosen(4, 0);
    for (std::size_t i = 0; i < 2000; ++i) {
        SimulatedObserver observer(study, {.protocol_hash = "h", .participant = "p", .purpose = {}},
                                   {0, 1, 2, 3}, [] { return true; });
        if (touched && i < 400) {
            observer.feel(std::span(ticks).first(50));
        }
        ++chosen[observer.choose({.done = i}, which_of(pictures)).place];
    }
    for (const int n : chosen) {
        CHECK(std::abs(n - 500) < 5 * 20);  // standard deviation 19.4
    }
}
