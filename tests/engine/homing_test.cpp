#include "engine/device/homing.hpp"
#include "engine/device/pantograph.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

namespace {

/// A machine as its maker knows it, and as it stands on the desk.
struct Desk {
    PantographSpec known;
    PantographSpec real;
};

Desk any_desk(Random& random, bool scaled) {
    Desk desk;
    FiveBar& linkage = desk.known.linkage;
    linkage.driven_1 = random.in(0.060, 0.070);
    linkage.driven_2 = random.in(0.060, 0.070);
    linkage.free_1 = random.in(0.075, 0.090);
    linkage.free_2 = random.in(0.075, 0.090);
    linkage.base = random.in(0.0, 0.030);
    desk.known.turn = random.in(-0.2, 0.2);
    desk.known.origin = {0.5 * linkage.base, 0.055};
    desk.real = desk.known;
    for (Axis& axis : desk.real.axes) {
        axis.zero = random.in(-kPi, kPi);
        if (scaled) {
            axis.counts_per_turn *= random.in(0.95, 1.05);
        }
    }
    return desk;
}

MarkReading read_at(const PantographSpec& real, const Vec2& place, const Vec2& aimed_off = {}) {
    const Pantograph machine(real);
    MarkCounts counts;
    counts.add(machine.counts(machine.reach(place + aimed_off).value()));
    return counts.at(place);
}

std::vector<MarkReading> read_all(const PantographSpec& real, const std::vector<Vec2>& places) {
    std::vector<MarkReading> marks;
    for (const Vec2& place : places) {
        marks.push_back(read_at(real, place));
    }
    return marks;
}

double turned(double angle) {
    return std::fabs(std::remainder(angle, 2.0 * kPi));
}

const std::vector<Vec2> kTriangle{{-0.030, 0.0}, {0.030, 0.005}, {0.0, 0.035}};

std::string refusal(const PantographSpec& spec, const std::vector<MarkReading>& marks, bool scale) {
    return refusal_of<HomingError>([&] { return find_home(spec, marks, scale); });
}

}  // namespace

TEST_CASE("one mark gives both zeros exactly, several give them to half a count") {
    SEEDED(random, std::uint64_t{500});
    const Desk desk = any_desk(random, false);
    const double count = 2.0 * kPi / desk.known.axes[0].counts_per_turn;
    const Homing one = find_home(desk.known, read_all(desk.real, {{0.01, 0.02}}), false);
    const Homing three = find_home(desk.known, read_all(desk.real, kTriangle), false);
    CHECK(one.worst < 1e-12);
    CHECK(three.worst < 20e-6);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(turned(one.axes[i].zero - desk.real.axes[i].zero) <= 0.5001 * count);
        CHECK(turned(three.axes[i].zero - desk.real.axes[i].zero) <= 0.5001 * count);
        CHECK(std::fabs(one.axes[i].zero) <= kPi);
        CHECK(one.axes[i].counts_per_turn == desk.known.axes[i].counts_per_turn);
    }
}

TEST_CASE("a person's aim is averaged: several marks are nearer to the truth than one") {
    double one_mark = 0.0;
    double many_marks = 0.0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed);
        const Desk desk = any_desk(random, false);
        std::vector<MarkReading> marks;
        for (int i = 0; i < 9; ++i) {
            const Vec2 place{(i % 3 - 1) * 0.025, (i / 3) * 0.02};
            marks.push_back(read_at(desk.real, place, random.point(-0.3e-3, 0.3e-3)));
        }
        const Homing many = find_home(desk.known, marks, false);
        const Homing one = find_home(desk.known, {marks.data() + 4, 1}, false);
        for (std::size_t i = 0; i < 2; ++i) {
            many_marks += turned(many.axes[i].zero - desk.real.axes[i].zero);
            one_mark += turned(one.axes[i].zero - desk.real.axes[i].zero);
        }
        CHECK(many.worst < 1e-3);
        CHECK(many.residuals.size() == marks.size());
    }
    CHECK(many_marks < 0.5 * one_mark);
}

TEST_CASE("three marks give the counts per turn as well") {
    SEEDED(random, std::uint64_t{300});
    const Desk desk = any_desk(random, true);
    const Homing found = find_home(desk.known, read_all(desk.real, kTriangle), true);
    CHECK(found.worst < 20e-6);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(std::fabs(found.axes[i].counts_per_turn / desk.real.axes[i].counts_per_turn - 1.0) <
              5e-4);
    }
    // What counts: the handle is found elsewhere as well.
    PantographSpec calibrated = desk.known;
    calibrated.axes = found.axes;
    const Pantograph real(desk.real);
    const Pantograph::Counts counts = real.counts(real.reach({0.015, 0.02}).value());
    const auto fix = Pantograph(calibrated).locate(Pantograph(calibrated).angles(counts));
    REQUIRE(fix);
    CHECK(glm::length(fix->hip - Vec2{0.015, 0.02}) < 40e-6);
}

TEST_CASE("readings that cannot be are refused with a number and a remedy") {
    Random random(3);
    const Desk desk = any_desk(random, false);
    std::vector<MarkReading> marks = read_all(desk.real, kTriangle);
    CHECK(refusal(desk.known, {}, false) == "there is no mark: give at least one");
    CHECK_THAT(refusal(desk.known, {marks[0], marks[1]}, true), Has("three marks, 2 were given"));
    CHECK_THAT(
        refusal(desk.known, read_all(desk.real, {{-0.03, 0.0}, {0.0, 0.0}, {0.03, 0.001}}), true),
        Has("lie in line"));
    CHECK_THAT(
        refusal(desk.known, read_all(desk.real, {{0.0, 0.0}, {0.003, 0.0}, {0.0, 0.003}}), true),
        Has("too close"));

    MarkReading far = marks[0];
    far.place = {0.5, 0.0};
    CHECK_THAT(refusal(desk.known, {far}, false), Has("(500, 0) mm is out of"));

    // Two marks taken for one another, and a handle put 3 mm beside its mark.
    std::vector<MarkReading> swapped = marks;
    std::swap(swapped[0].place, swapped[1].place);
    CHECK_THAT(refusal(desk.known, swapped, false), Has("more than 1 mm"));
    std::vector<MarkReading> beside = marks;
    beside[2] = read_at(desk.real, kTriangle[2], {0.003, 0.0});
    CHECK_THAT(refusal(desk.known, beside, false), Has("is missed by"));

    // An encoder that counts the other way, and one of another make.
    std::vector<MarkReading> reversed = marks;
    for (MarkReading& mark : reversed) {
        mark.counts.y = -mark.counts.y;
    }
    CHECK_THAT(refusal(desk.known, reversed, false), Has("directions"));
    PantographSpec other = desk.known;
    other.axes[1].counts_per_turn *= 1.3;
    CHECK_THAT(refusal(other, marks, true), Has("axis 2 would count"));

    // 0.3 mm and a count are a resting hand; more is a moving one.
    const Pantograph machine(desk.real);
    const double lever =
        glm::length(machine.locate(machine.reach(kTriangle[0]).value())->jacobian.column_1());
    const double count = lever * 2.0 * kPi / 65536.0;
    std::vector<MarkReading> moving = marks;
    moving[0].span.x = std::floor(0.25e-3 / count);
    CHECK(refusal(desk.known, moving, false) == "accepted");
    moving[0].span.x = std::ceil(0.45e-3 / count);
    CHECK_THAT(refusal(desk.known, moving, false), Has("hold it still"));
}

TEST_CASE("the counts at a mark are averaged, and their span is kept") {
    MarkCounts counts;
    CHECK_THROWS_AS(counts.at({}), std::invalid_argument);
    counts.add({-5, 2'000'000'000});
    counts.add({-2, 2'000'000'001});
    counts.add({-2, 2'000'000'003});
    const MarkReading mark = counts.at({0.001, 0.002});
    CHECK(counts.readings() == 3);
    CHECK(mark.counts.x == -3.0);
    CHECK(std::fabs(mark.counts.y - 2'000'000'001.0 - 1.0 / 3.0) < 1e-6);
    CHECK(mark.span == Vec2{3.0, 3.0});
}

TEST_CASE("a driver that counts from the home pose is right after a calibration too") {
    int moved = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Random random(seed);
        CAPTURE(seed);
        const Desk desk = any_desk(random, seed % 2 == 1);
        Calibration known{.pantograph = desk.known, .haply = {}, .comedi = {}, .home = Vec2{}};
        known.home = Vec2{random.in(-0.01, 0.01), random.in(0.01, 0.03)};
        // Where the handle truly rests at switch-on is 0 to 7 mm beside the home that is believed.
        const Vec2 rest = *known.home + random.point(-0.005, 0.005);
        PantographSpec real = desk.real;
        const JointAngles at_rest = Pantograph(real).reach(rest).value();

        // A driver: counts since switch-on, and those of the home pose.
        const auto counts_with = [&](const Calibration& calibration, const Vec2& place) {
            const Pantograph machine(calibration.pantograph);
            const Pantograph::Counts home =
                machine.counts(machine.reach(*calibration.home).value());
            const JointAngles there = Pantograph(real).reach(place).value();
            Pantograph::Counts counts{};
            for (std::size_t i = 0; i < 2; ++i) {
                const double turns = std::remainder(there[i] - at_rest[i], 2.0 * kPi) / (2.0 * kPi);
                counts[i] = home[i] + static_cast<std::int32_t>(
                                          std::floor(turns * real.axes[i].counts_per_turn + 0.5));
            }
            return counts;
        };
        std::vector<MarkReading> marks;
        for (const Vec2& place : kTriangle) {
            MarkCounts counts;
            counts.add(counts_with(known, place));
            marks.push_back(counts.at(place));
        }
        const Calibration after = calibrated(known, find_home(desk.known, marks, seed % 2 == 1));
        CHECK(glm::length(*after.home - rest) < 40e-6);
        moved += glm::length(*after.home - *known.home) > 1e-3 ? 1 : 0;
        const Vec2 place{0.02, 0.01};
        const Pantograph machine(after.pantograph);
        const auto fix = machine.locate(machine.angles(counts_with(after, place)));
        REQUIRE(fix);
        CHECK(glm::length(fix->hip - place) < 60e-6);
    }
    CHECK(moved > 200);
}
