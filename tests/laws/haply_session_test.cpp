#include "protocols/file/calibration_file.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/session/session.hpp"
#include "protocols/trial/emulated_haply_apparatus.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::protocols;

// Whole sessions over an emulated board, in real time, with board and guard as processes of their
// own. Nothing is asserted about time.

namespace {

protocols::Protocol two_trials() {
    protocols::Protocol protocol = small_protocol();
    protocol.id = "two";
    protocol.objects.erase(protocol.objects.begin() + 1);
    protocol.frictions.erase(protocol.frictions.begin());
    protocol.apparatus.stiffness = 200.0;
    protocol.apparatus.force_limit = 1.5;
    protocol.invalid = {
        .late_share = 1.0, .contact_min = 0.0, .path_min = 0.0};  // of the machine's load
    return protocol;
}

struct Kept : protocols::Recorder {
    struct Trial {
        protocols::Condition condition;
        std::vector<engine::TickRecord> ticks;
        protocols::TrialResult result;
    };
    std::vector<Trial> trials;
    Words events;
    bool finished = false;

    TrialId begin_trial(const protocols::PlannedTrial& planned) override {
        trials.push_back({.condition = planned.condition, .ticks = {}, .result = {}});
        return static_cast<TrialId>(trials.size()) - 1;
    }
    void append(TrialId id, std::span<const engine::TickRecord> ticks) override {
        auto& all = trials[static_cast<std::size_t>(id)].ticks;
        all.insert(all.end(), ticks.begin(), ticks.end());
    }
    void end_trial(TrialId id, const protocols::TrialResult& result) override {
        trials[static_cast<std::size_t>(id)].result = result;
    }
    void event(const protocols::Event& event) override { events.emplace_back(event.text); }
    void finish_session() override { finished = true; }
};

/// A simulated observer who pulls the plug once, while a force is felt, and puts it in again.
class Clumsy : public protocols::SimulatedObserver {
public:
    Clumsy(const protocols::Protocol& protocol,
           const data::SessionSpec& spec,
           protocols::EmulatedHaplyApparatus& apparatus,
           bool clumsy)
        : SimulatedObserver(protocol,
                            session_stream(spec),
                            spec.plan.picture_order,
                            [&apparatus] { return apparatus.hand_is_done(); }),
          apparatus_(&apparatus),
          pulls_(clumsy) {}

    protocols::ExplorationStep explore(const protocols::TrialView& trial, double elapsed) override {
        if (pulls_ && !apparatus_->board().motors().off()) {
            pulls_ = false;
            apparatus_->board().plug(false);
        }
        return SimulatedObserver::explore(trial, elapsed);
    }
    std::optional<protocols::Signal> trouble(const protocols::TroubleView& view) override {
        sentences.push_back(view.sentence);
        if (view.tries == 2) {  // one in vain
            apparatus_->board().plug(true);
        }
        return view.solved ? std::optional(protocols::Signal::go_on) : std::nullopt;
    }
    Words sentences;

private:
    protocols::EmulatedHaplyApparatus* apparatus_;
    bool pulls_;
};

/// Ticks whose force does not come back to the bit from the recorded HIP.
int wrong_forces(const protocols::Protocol& protocol, const Kept::Trial& trial) {
    const engine::Scene scene = protocols::make_scene(protocol, trial.condition);
    engine::ContactState state;
    int wrong = 0;
    for (const engine::TickRecord& tick : trial.ticks) {
        const engine::Contact contact = scene.tick(state, engine::Vec2(tick.hip));
        wrong += std::memcmp(&contact.force, &tick.force, sizeof contact.force) == 0 ? 0 : 1;
    }
    return wrong;
}

}  // namespace

TEST_CASE(
    "a session over an emulated board ends with motors at zero, and goes on after an unplugging",
    "[haply]") {
    EACH(unplugged, false, true);
    const TemporaryFile file("board");
    const protocols::Protocol protocol = two_trials();
    const data::SessionSpec spec = session_spec(protocol);
    protocols::EmulatedHaplyApparatus apparatus(
        protocol, protocols::DrawnHand(protocol, spec.protocol_hash, spec.key, spec.seed),
        protocols::load_calibration("2diy_gen3"), 0.0, file);
    Clumsy observer(protocol, spec, apparatus, unplugged);
    Kept kept;
    const auto end = protocols::run_session(
        protocol, spec.plan,
        {.title = {}, .participant = {}, .trials = spec.plan.trials.size(), .device = {}},
        protocols::SessionProgress(protocol, spec.plan, {}),
        {.apparatus = apparatus, .observer = observer, .recorder = kept});
    CAPTURE(observer.sentences, kept.events);
    REQUIRE(end.why == protocols::SessionEnd::Why::finished);
    CHECK(kept.finished);

    const engine::BoardLog log = apparatus.board().journal();
    CHECK(apparatus.board().motors().off());
    CHECK(log.hot_resets == 0);
    CHECK(log.undefined_duty == 0);
    CHECK(log.id_0 == 0);
    CHECK(log.unknown == 0);
    CHECK(log.setups >= (unplugged ? 2 : 1));

    // A machine under load may fault a trial more: it is kept and run again like the unplugged one.
    REQUIRE(kept.trials.size() >= (unplugged ? 3 : 2));
    std::size_t complete = 0;
    for (std::size_t i = 0; i < kept.trials.size(); ++i) {
        const Kept::Trial& trial = kept.trials[i];
        CAPTURE(i, trial.ticks.size());
        CHECK(wrong_forces(protocol, trial) == 0);
        if (trial.result.outcome == Outcome::faulted) {
            REQUIRE(trial.result.fault);
            CHECK(trial.result.fault->cause != engine::Trip::none);
            CHECK_FALSE(trial.result.fault->last.empty());
            continue;
        }
        ++complete;
        CHECK(trial.result.outcome == Outcome::complete);
        CHECK(trial.result.summary.contact_ticks > 0);
        CHECK(trial.result.summary.max_normal_force_n > 0.1);
    }
    CHECK(complete == 2);
    if (unplugged) {
        CHECK_FALSE(observer.sentences.empty());
        const auto lost = std::find_if(kept.trials.begin(), kept.trials.end(), [](const auto& one) {
            return one.result.fault && one.result.fault->cause == engine::Trip::device_lost;
        });
        REQUIRE(lost != kept.trials.end());
        CHECK(std::any_of(lost + 1, kept.trials.end(), [&](const auto& one) {  // run again
            return one.condition == lost->condition && one.result.outcome == Outcome::complete;
        }));
        CHECK(std::any_of(kept.events.begin(), kept.events.end(), [](const std::string& text) {
            return text.starts_with("the device works");
        }));
    }
}
