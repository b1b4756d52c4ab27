#include "protocols/file/calibration_file.hpp"
#include "protocols/observer/simulated_observer.hpp"
#include "protocols/session/session.hpp"
#include "protocols/trial/emulated_haply_apparatus.hpp"
#include "tests/support/catch.hpp"
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

/// A simulated observer who pulls the plug once, while a force is felt, and puts it in again.
class Clumsy : public protocols::SimulatedObserver {
public:
    Clumsy(const data::SessionSpec& spec, protocols::EmulatedHaplyApparatus& apparatus, bool clumsy)
        : SimulatedObserver(spec.protocol,
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

}  // namespace

TEST_CASE(
    "a session over an emulated board ends with motors at zero, and goes on after an unplugging",
    "[haply]") {
    EACH(unplugged, false, true);
    SmallSession session(two_trials());
    const data::SessionSpec& spec = session.spec;
    protocols::EmulatedHaplyApparatus apparatus(
        spec.protocol, protocols::DrawnHand(spec.protocol, spec.protocol_hash, spec.key, spec.seed),
        protocols::load_calibration("2diy_gen3"), 0.0, session.folder.file("board"));
    Clumsy observer(spec, apparatus, unplugged);
    const auto end = protocols::run_session(
        spec.protocol, spec.plan,
        {.title = {}, .participant = {}, .trials = spec.plan.trials.size(), .device = {}},
        session.progress,
        {.apparatus = apparatus, .observer = observer, .recorder = session.recorder});
    data::Database& file = session.database;
    CAPTURE(observer.sentences, lines(file, "SELECT text FROM event"));
    REQUIRE(end.why == protocols::SessionEnd::Why::finished);
    CHECK(count(file, "session WHERE finished") == 1);

    const engine::BoardLog log = apparatus.board().journal();
    CHECK(apparatus.board().motors().off());
    CHECK(log.hot_resets == 0);
    CHECK(log.undefined_duty == 0);
    CHECK(log.id_0 == 0);
    CHECK(log.unknown == 0);
    CHECK(log.setups >= (unplugged ? 2 : 1));

    const data::Verification found = data::verify(file);
    CHECK(text_of(found, false) == "");  // every force comes back to the bit from the recorded HIP
    CHECK(found.sessions.at(0).replayed > 1000);
    CHECK(count(file, "trial WHERE outcome = 'complete'") == 2);
    CHECK(count(file,
                "trial WHERE contact_ticks > 0 AND max_normal_force_n > 0.1 AND outcome = "
                "'complete'") == 2);
    // A machine under load may fault a trial more: it is kept and run again like the unplugged one.
    CHECK(count(file, "trial WHERE outcome NOT IN ('complete', 'faulted')") == 0);
    CHECK(count(file,
                "trial WHERE outcome = 'faulted' AND (fault_cause = 'none' OR trial_id NOT "
                "IN (SELECT trial_id FROM fault_tick))") == 0);
    if (unplugged) {
        CHECK_FALSE(observer.sentences.empty());
        CHECK(count(file,
                    "trial AS lost JOIN trial AS again USING (plan_position) WHERE "
                    "lost.fault_cause = 'device_lost' AND again.outcome = 'complete'") >= 1);
        CHECK(count(file, "event WHERE text LIKE 'the device works%'") >= 1);
    }
}
