#include "protocols/design/object_outline.hpp"
#include "protocols/observer/cues.hpp"
#include "protocols/session/progress.hpp"
#include "protocols/session/trial_meter.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "tests/support/frame.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/short_text.hpp"
#include "tests/support/test_text.hpp"

using namespace palpate::protocols;

namespace {

std::string softness_study() {
    return short_text("softness_2afc");
}

/// What is said of the shipped study with one edit.
std::string said(const std::string& from, const std::string& to) {
    return tests::refusal(tests::replaced(softness_study(), from, to));
}

/// The press of a hand that goes in along the normal in the middle of A-V, and waits.
std::vector<engine::TickRecord> press(const engine::Scene& scene) {
    const engine::Frame at = engine::frame_at(scene.outline().spans()[0], 0.5);
    std::vector<engine::TickRecord> ticks(2000);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const double depth = 0.003 * std::min(1.0, static_cast<double>(i) / 1000.0);
        ticks[i].hip = engine::Vec3(at.point + (0.0005 - depth) * at.normal, 0.0);
    }
    engine::FeltState state;
    engine::set_contacts(ticks, scene, state);
    return ticks;
}

}  // namespace

TEST_CASE("a compliance is read in mm/N, written again, and felt by its scene alone") {
    const Protocol protocol = parse_protocol(softness_study(), "p.toml");
    REQUIRE(protocol.objects.size() == 1);
    CHECK(protocol.objects[0].compliance == Approx(1e-3).epsilon(1e-15));
    CHECK(parse_protocol(to_toml(protocol), "again.toml") == protocol);
    const engine::Scene scene = make_scene(protocol, Condition{});
    REQUIRE(scene.soft() != nullptr);
    CHECK(scene.soft()->compliance_at({0, 1.0}) == Approx(1e-3).epsilon(1e-12));
    Protocol rigid = protocol;
    rigid.objects[0].compliance = 0.0;
    CHECK(make_scene(rigid, Condition{}).soft() == nullptr);
    CHECK(parse_protocol(to_toml(rigid), "rigid.toml") == rigid);
    CHECK(silhouette_of(rigid, 0) == silhouette_of(protocol, 0));  // pictures show the rest
}

TEST_CASE("what a soft object cannot have is refused where it stands, with a remedy") {
    CHECK(said("compliance_mm_per_n = 1 ", "compliance_mm_per_n = 0.2 ") == "accepted");
    for (const auto& row : test_rows("soft_problems.tsv")) {
        CAPTURE(row);
        CHECK_THAT(said(row.at(0), row.at(1)), Has(row.at(2)));
    }
}

TEST_CASE("a rule that varies the compliance feels what it chose, and the softer one is right") {
    const Protocol protocol = parse_protocol(softness_study(), "p.toml");
    for (const std::size_t interval : {std::size_t{1}, std::size_t{2}}) {
        for (const double stimulus : {-0.6, -0.05, 0.0, 0.3}) {
            const PlannedTrial planned{.adaptive = AdaptiveTrial{.comparison = interval}};
            const auto felt = presentations_of(protocol, planned, stimulus);
            REQUIRE(felt.size() == 2);
            const Presentation& chosen = felt[interval - 1];
            CHECK(chosen.object.compliance ==
                  Approx(1e-3 * std::pow(10.0, stimulus)).epsilon(1e-12));
            CHECK(varied_value(*protocol.procedure, chosen) ==
                  Approx(std::pow(10.0, stimulus)).epsilon(1e-12));
            CHECK(felt[2 - interval].object.compliance == protocol.objects[0].compliance);
            CHECK(make_scene(protocol, chosen).spec().compliance == chosen.object.compliance);
            const auto right = is_right(protocol, {}, planned, felt, interval - 1);
            CHECK(right == (stimulus == 0.0 ? std::nullopt : std::optional(stimulus > 0.0)));
        }
    }
}

TEST_CASE("a hand finds the contact's spring and the surface's compliance in series") {
    Protocol protocol = parse_protocol(softness_study(), "p.toml");
    double before = 0.0;
    for (const double c : {0.0, 2e-4, 1e-3, 4e-3}) {
        protocol.objects[0].compliance = c;
        const engine::Scene scene = make_scene(protocol, Condition{});
        SoftnessCues cues(protocol);
        CHECK_FALSE(cues.softness());
        cues.add(press(scene));
        REQUIRE(cues.softness());
        const double own = c > 0.0 ? scene.soft()->compliance_at({0, 0.5}) : 0.0;
        CHECK(*cues.softness() == Approx(1e-3 + own).epsilon(0.05));
        CHECK(*cues.softness() > before);
        before = *cues.softness();
    }
}

TEST_CASE(
    "an episode is one coming into contact, and those of a soft object give no more together") {
    const Protocol protocol = parse_protocol(softness_study(), "p.toml");
    const engine::Scene scene = make_scene(protocol, Condition{});
    const engine::Frame at = engine::frame_at(scene.outline().spans()[0], 0.5);
    // In by 8 mm, off at once, and again upon the surface that comes back; then slowly out.
    std::vector<engine::TickRecord> ticks(3000);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const auto t = static_cast<double>(i);
        const double depth =
            i < 400 ? 0.00002 * t - 0.0005 : std::max(0.002 - 4e-6 * (t - 400), -1e-3);
        ticks[i].hip = engine::Vec3(at.point - depth * at.normal, 0.0);
        ticks[i].time_ns = static_cast<std::int64_t>(i) * 1'000'000;
    }
    engine::FeltState state;
    engine::set_contacts(ticks, scene, state);
    TrialMeter meter(protocol.apparatus.stiffness, scene);
    meter.add(ticks);
    engine::EnergyLedger<3> contacts(protocol.apparatus.stiffness);
    for (const engine::TickRecord& tick : ticks) {
        contacts.add(tick.hip, tick.force, tick.mode != engine::Mode::free);
    }
    CHECK(contacts.episodes() == 2);
    CHECK(contacts.worst() > 1e-4);  // the second contact gives back what the first stored
    CHECK(meter.summary().contact_episodes == 2);
    CHECK(meter.summary().worst_episode_j < 0.0);
    CHECK(std::ranges::none_of(ticks, [](const engine::TickRecord& tick) {
        return (tick.flags & engine::tick_outside_cone) != 0;
    }));
    CHECK(ticks.back().mode == engine::Mode::free);
}
