#include "protocols/session/trouble.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/base/clock.hpp"
#include "engine/base/text.hpp"

namespace palpate::protocols {
namespace {

constexpr const char* kWorksAgain = "the device works again";

/// The way from a fault to a rig that may give force again.
class Repair {
public:
    Repair(Ports& ports, const Fault& fault, std::size_t in_a_row, const TrustPort& rig)
        : ports_(ports), fault_(fault), rig_(rig), stopped_(fault.cause == engine::Trip::stopped) {
        view.in_a_row = in_a_row;
        view.by_hand = waits_for_experimenter(fault.cause);
        ask_for_experimenter();
        look();
    }

    /// Nobody wants a force until the experimenter goes on: no pulse moves the handle. Whoever
    /// wanted it may have changed the rig, whatever went before.
    void stop(std::string_view way) {
        view.by_hand = true;
        stopped_ = true;
        cause_ = way == kKeyboardElsewhere ? cause_ : to_string(engine::Trip::stopped);
    }

    /// One step: the device has to come back whatever is trusted, then what is not proved is.
    /// @param waited_s  that the session slept since the fault
    void try_on(double waited_s) {
        const bool proves = back_ && !stopped_;
        if (rig_.trust.state == Trust::unknown) {  // until it is back
            ports_.apparatus.doubt_plugs();
        }
        ProofStep step = prove_step(ports_.apparatus, proves ? rig_.trust.state : Trust::unknown);
        look();
        if (!step.event) {
            ++view.tries;
            sentence_ = step.refused.empty() ? fault_.text : step.refused;
            if (proves && rig_.trust.state == Trust::at_home && !rig_.trust.place_old) {
                const Event refused = refused_proof(rig_.trust, sentence_, kRefusedInTrouble);
                sentence_ = refused.text;
                rig_.happened(refused);
            }
            return;
        }
        if (!back_) {
            step.event->text += ", after " + counted(view.tries, "try", "tries") + " in vain";
            step.event->count = static_cast<std::int64_t>(view.tries);
        }
        if (step.event->key ==
            kRigCheck) {  // nobody could change the rig before it and be believed
            step.event->duration_s = lasted(waited_s);
            slept_s_ = waited_s;
            begun_ns_ = monotonic_ns();
        }
        back_ = true;
        rig_.happened(*step.event);
        ask_for_experimenter();
        solved_ = stopped_ || !ports_.apparatus.has_proof() || rig_.trust.state == Trust::proved;
        // No longer why it could not be reached; or what comes next.
        sentence_ = !solved_ ? kProofComes : was_away_ ? kWorksAgain : fault_.text;
    }

    /// Found right, and not left to itself since: a device that goes away meanwhile is waited for.
    void look_again() {
        const auto place = ports_.apparatus.place();
        const std::string trouble = ports_.apparatus.trouble();
        const bool away = place && !std::isfinite(place->x) && !trouble.empty();
        if (std::exchange(away_, away) && away) {  // twice: it was not just late
            solved_ = back_ = false;
            sentence_ = trouble;
            rig_.happened({.kind = EventKind::fault,
                           .text = "while the session waited: " + trouble,
                           .value = std::string(to_string(ports_.apparatus.place_fault()))});
        }
    }

    [[nodiscard]] bool solved() const { return solved_; }

    /// What is to be said now: also of what stands against every force, as long as it does.
    void say_now() {
        const char* barred = ports_.desk->barred();
        view.solved = solved_ && barred == nullptr;
        view.sentence = solved_ && barred != nullptr ? barred : sentence_;
    }

    /// @param waited_s  as of try_on()
    void go_on(double waited_s) {
        rig_.happened({.kind = EventKind::go_on,
                       .text = fmt::format("after {}", cause_),
                       .duration_s = lasted(waited_s),
                       .value = std::string(cause_)});
    }

    TroubleView view;

private:
    /// Seconds since the fault, or since the motors were proved after it. With a real device trying
    /// takes time as well, and a program that was held sleeps longer.
    [[nodiscard]] double lasted(double waited_s) const {
        const double passed = static_cast<double>(monotonic_ns() - begun_ns_) * 1e-9;
        const double slept = waited_s - slept_s_;
        return ports_.apparatus.gives_force() ? std::max(slept, passed) : slept;
    }

    /// Whether it is away, and whether the force is off.
    void look() {
        was_away_ = was_away_ || !ports_.apparatus.trouble().empty();
        ports_.desk->doubt_force(ports_.apparatus.force_unproved());
    }

    /// Whoever felt the rig before cannot tell whether it is the same.
    void ask_for_experimenter() {
        const bool unknown = ports_.apparatus.has_proof() && rig_.trust.state == Trust::unknown;
        view.by_hand |= unknown || (ports_.apparatus.gives_force() && rig_.trust.by_hand);
    }

    Ports& ports_;
    const Fault& fault_;
    const TrustPort& rig_;
    bool stopped_;
    bool solved_ = false;
    std::string sentence_{fault_.text};
    std::string_view cause_{fault_.cause != engine::Trip::none ? to_string(fault_.cause)
                                                               : kRigCheck};
    std::int64_t begun_ns_ = monotonic_ns();
    double slept_s_ = 0.0;
    bool back_ = false;
    bool away_ = false;      ///< when it was last looked at, after it was found right
    bool was_away_ = false;  ///< what was said of it is no longer so
};

}  // namespace

const char* note_stop(Ports& ports, std::optional<TrialId> trial) {
    const char* way = ports.desk->take_stop();
    if (way != nullptr) {
        ports.recorder.event({.kind = EventKind::stop,
                              .text = fmt::format("no force is wanted: {}", way),
                              .trial = trial,
                              .value = way});
    }
    return way;
}

MendResult mend(Ports& ports,
                const Fault& fault,
                std::size_t in_a_row,
                const TrustPort& rig,
                std::optional<TrialId> trial) {
    Repair mending(ports, fault, in_a_row, rig);
    TroubleView& view = mending.view;
    TroubleView said_last;
    for (std::size_t slice = 0;; ++slice) {
        const double waited_s = static_cast<double>(slice) * kTroubleSlice;
        if (const char* way = note_stop(ports, trial)) {
            mending.stop(way);
        }
        if (slice % kSlicesPerTry == 0) {
            mending.solved() ? mending.look_again() : mending.try_on(waited_s);
        }
        mending.say_now();
        if (ports.interrupted()) {
            return {Signal::abort, view.tries};
        }
        if (said_last.sentence != view.sentence || said_last.solved != view.solved) {
            ports.alarm(said_last = view);
        }
        const std::optional<Signal> said = ports.observer.trouble(view);
        if (said == Signal::abort || said == Signal::give_up) {
            return {*said, view.tries};
        }
        if (said == Signal::go_on && view.solved) {
            mending.go_on(waited_s);
            ports.apparatus.allow();  // a stop after that is the next trial's, and holds it
            return {Signal::go_on, view.tries};
        }
        ports.pause(kTroubleSlice);
    }
}

}  // namespace palpate::protocols
