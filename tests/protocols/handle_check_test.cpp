#include <map>

#include "protocols/session/handle_check.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate;
using namespace palpate::protocols;
using tests::FaultyApparatus;
using tests::Patient;
using tests::plan_of;
using tests::short_protocol;
using tests::World;

namespace {

/// Keeps the kinds of events.
class Kinds : public Recorder {
public:
    TrialId begin_trial(const PlannedTrial& /*planned*/) override { return ++trial_; }
    void begin_interval(TrialId /*trial*/,
                        const Presentation& /*felt*/,
                        const SceneConstants& /*scene*/) override {}
    void append(TrialId /*trial*/, std::span<const engine::TickRecord> /*ticks*/) override {}
    void end_trial(TrialId /*trial*/, const TrialResult& /*result*/) override {}
    void event(const Event& event) override { ++count[event.kind]; }
    void finish_session() override {}

    std::map<EventKind, std::size_t> count;

private:
    TrialId trial_ = 0;
};

/// A device whose handle moves otherwise than it should for the first tries of each break.
class Unproved : public FaultyApparatus {
public:
    Unproved(World& world, int wrong) : FaultyApparatus(world), wrong_(wrong), left_(wrong) {}

    void begin(const engine::SceneView& scene,
               const PlannedTrial& planned,
               std::size_t interval) override {
        CHECK(right_);
        left_ = wrong_;
        FaultyApparatus::begin(scene, planned, interval);
    }
    [[nodiscard]] bool can_prove_handle() const noexcept override { return true; }
    [[nodiscard]] engine::ShortForm prove_handle() override {
        right_ = left_ == 0 && !force_on;
        left_ -= left_ > 0 ? 1 : 0;
        return right_ ? engine::ShortForm{.refused = {}, .found = "99 % at 1 deg"}
                      : engine::ShortForm{.refused = "a motor is too strong", .found = {}};
    }
    [[nodiscard]] bool reconnect() override { return prove_handle().refused.empty(); }
    [[nodiscard]] std::string trouble() const override {
        return right_ ? "" : "a motor is too strong";
    }

private:
    int wrong_;
    int left_;
    bool right_ = true;
};

}  // namespace

TEST_CASE("after a break no trial begins before weak pulses moved the handle as they should",
          "[session][fault][law]") {
    const int wrong = GENERATE(0, 1, 4);
    CAPTURE(wrong);
    const Protocol protocol = short_protocol();
    const Plan plan = plan_of(protocol);
    World world;
    Unproved apparatus(world, wrong);
    Patient observer;
    Kinds kept;
    const SessionEnd end = run_session(
        protocol, plan, {}, SessionProgress(protocol, plan, {}),
        {.apparatus = apparatus, .observer = observer, .recorder = kept, .pause = [](double) {
         }});
    CHECK(end.why == SessionEnd::Why::finished);
    REQUIRE(observer.rests.size() >= 2);
    CHECK(kept.count[EventKind::provenance] == observer.rests.size());
    CHECK(kept.count[EventKind::go_on] == (wrong > 0 ? observer.rests.size() : 0));
    CHECK((observer.troubles.empty() == (wrong == 0)));
    if (wrong > 1) {
        CHECK(observer.troubles.front().sentence == "a motor is too strong");
    }
}
