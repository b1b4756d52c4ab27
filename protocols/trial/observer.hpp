#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "stimuli/surface_patch.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/protocol/protocol.hpp"

/// The port to whoever answers: a person at a screen, or a simulated observer.
///
/// Blindness is in the types: until choose() no call carries anything that depends on the stimulus.
/// feel() is the exception, for simulated observers, whose percept comes from the felt ticks.
namespace palpate::protocols {

/// What a participant may know of the session when it begins.
struct SessionView {
    std::string title;
    std::string participant;
    std::size_t trials = 0;    ///< in the whole plan
    std::size_t next = 0;      ///< how many are answered, > 0 on resume
    std::size_t practice = 0;  ///< of those that are left
    bool breaks = false;       ///< there are some before these
    bool simulated = false;    ///< the run kind is simulated: the screen says so
    std::string device;        ///< e.g. "simulated pantograph"
};

/// What the participant may know of a trial while feeling. Nothing of the condition, ever.
struct TrialView {
    std::size_t number = 0;  ///< 1, 2, ...: practice by itself, main and catch trials together
    std::size_t total = 0;   ///< of the same
    bool practice = false;
    std::size_t done = 0;  ///< trials of the whole session: names the draws of a simulated observer
    std::size_t unanswered = 0;  ///< attempts at which nobody answered: the same
    double explore_min_s = 0.0;
    double explore_prompt_s = 0.0;
    double explore_timeout_s = 0.0;
    std::size_t interval = 1;  ///< of the trial, 1..intervals: each is begun and felt by itself
    std::size_t intervals = 1;

    friend bool operator==(const TrialView&, const TrialView&) = default;
};

/// What is wrong with the device, for whoever can mend it. Nothing of the condition, ever.
struct TroubleView {
    std::string sentence;      ///< what happened and what to do
    bool solved = false;       ///< the device works: the next trial may be asked for
    std::size_t tries = 0;     ///< how often the device was asked to come back, in vain
    std::size_t in_a_row = 1;  ///< faulted trials since the last good one
    bool by_hand = false;      ///< the experimenter has to go on, and not the participant

    friend bool operator==(const TroubleView&, const TroubleView&) = default;
};

/// When nobody is there to mend anything: failed tries, and faults in a row, after which to give
/// up.
inline constexpr std::size_t kMaxTries = 10;
inline constexpr std::size_t kMaxFaults = 3;

/// What a step of a trial ended with.
enum class Signal : std::uint8_t {
    go_on,
    done,      ///< explore: the participant pressed done
    abort,     ///< the experimenter (two steps) or the operating system ends the session
    give_up,   ///< trouble: nobody will mend it
    held_up,   ///< ready: nobody began; the desk wants something first
    no_place,  ///< ready: the device does not say any more where the handle is
    too_late,  ///< choose: nobody answered in time
};

/// How an answer was given.
enum class InputKind : std::uint8_t { simulated, key, arrows, mouse };

/// The enumerator's name, as the database has it.
[[nodiscard]] std::string_view to_string(InputKind kind) noexcept;

/// One of the pictures, ready to draw. Coordinates: object frame, m, y up.
struct Picture {
    std::vector<engine::Vec2> outline;               ///< closed polyline, chord error <= 20 um
    std::vector<std::vector<engine::Vec2>> lines{};  ///< open polylines within it, of a surface
    std::vector<stimuli::ShadedPoint> shade{};  ///< triangles within it, in threes, of a surface
    std::vector<std::vector<engine::Vec2>> walls{};  ///< of the block below, closed polylines
};

/// What is asked after feeling. The same for every trial of a session.
struct Question {
    ResponseKind kind = ResponseKind::identification;
    std::string text;                   ///< empty: the screen's own sentence
    std::span<const Picture> pictures;  ///< identification only, from the left
    std::size_t answers = 0;            ///< an answer is 0 .. answers - 1
    /// yes_no: of no and yes; rating: of the first and the last level. Empty: the screen's own
    /// words.
    std::vector<std::string> labels;
    bool confidence = false;  ///< asked for after the answer
    bool confirm = false;     ///< answer and confidence can be changed until they are confirmed
    double timeout_s = 0.0;   ///< of answer and confidence each, then nobody answers; 0: none
};

/// How sure one is of an answer: 1 (a guess) .. kMaxConfidence.
inline constexpr int kMaxConfidence = 4;

/// How an answer came about that could be changed until it was confirmed. Times since the question
/// was shown.
struct Confirmation {
    double first_choice_s = 0.0;  ///< until the first answer was marked
    double confirmed_s = 0.0;     ///< until the marked one was confirmed
    std::size_t changes = 0;  ///< times that another one was marked; each step of the arrows is one

    friend bool operator==(const Confirmation&, const Confirmation&) = default;
};

/// An answer, and how it came about. Times are s.
struct Choice {
    Signal signal = Signal::done;  ///< done, abort or too_late
    /// Which answer, 0 .. Question::answers - 1: the picture from the left; 0 first, 1 second
    /// interval; 0 no, 1 yes; the level of a rating.
    std::size_t place = 0;
    double reaction_s = 0.0;     ///< question shown -> the press that gave this answer
    double uncertainty_s = 0.0;  ///< how late that press may have been seen
    InputKind input = InputKind::simulated;
    std::optional<int> confidence{};     ///< 1 .. kMaxConfidence, if the question asks for it
    double confidence_reaction_s = 0.0;  ///< scale shown -> confidence; 0 if not asked for
    std::size_t early_presses = 0;  ///< too early to be an answer, at the question or the scale
    double away_s = 0.0;  ///< that the keyboard was elsewhere meanwhile: a window before, or none
    std::optional<Confirmation> confirmation{};  ///< if the question asks for it
    std::optional<Confirmation> confidence_confirmation{};
};

/// What is seen of the person during one step of an exploration.
struct ExplorationStep {
    Signal signal = Signal::go_on;
    double at_s = 0.0;           ///< when done was pressed, since the trial's first tick
    double uncertainty_s = 0.0;  ///< how late the press may have been seen
    bool alive = true;  ///< a key that ends the force would be seen; else it is not to last
};

/// Whoever feels and answers. One thread; calls come in the order of a trial.
class Observer {
public:
    Observer() = default;
    Observer(const Observer&) = delete;
    Observer& operator=(const Observer&) = delete;
    virtual ~Observer() = default;

    /// Before the first trial of a run: instructions.
    [[nodiscard]] virtual Signal welcome(const SessionView& session) = 0;
    /// Blocks until the participant is at the start and begins. Called before each interval of a
    /// trial. go_on, abort, no_place, or before the first interval held_up.
    [[nodiscard]] virtual Signal ready(const TrialView& trial) = 0;
    /// Called again and again while the object is felt; must return within a few ms.
    /// @param elapsed_s time since the trial's first tick, on the servo's clock
    [[nodiscard]] virtual ExplorationStep explore(const TrialView& trial, double elapsed_s) = 0;
    /// Ticks of the running trial in order; only simulated observers use them.
    virtual void feel(std::span<const engine::TickRecord> ticks) { static_cast<void>(ticks); }
    /// Force is off; the question.
    [[nodiscard]] virtual Choice choose(const TrialView& trial, const Question& question) = 0;
    /// After an answer, where the protocol says so: was it right? go_on or abort. The default tells
    /// nobody.
    [[nodiscard]] virtual Signal feedback(const TrialView& /*trial*/, bool /*correct*/) {
        return Signal::go_on;
    }
    /// Blank screen between two trials, s. go_on or abort.
    [[nodiscard]] virtual Signal gap(double seconds) = 0;
    /// A break of at least `seconds`; returns when the participant goes on. go_on or abort.
    [[nodiscard]] virtual Signal rest(double seconds, const TrialView& next) = 0;
    /// The experimenter asked for a pause; returns when the experimenter ends it. go_on or abort.
    /// The default has nobody to wait for.
    [[nodiscard]] virtual Signal pause(const TrialView& /*next*/) { return Signal::go_on; }
    /// After a fault, again and again, with the device asked in between; must return within a few
    /// ms. go_on (taken only when solved), abort, give_up, or nothing: still waiting. The default
    /// has nobody to wait for: it goes on at once when solved, and gives up after kMaxTries or
    /// kMaxFaults.
    [[nodiscard]] virtual std::optional<Signal> trouble(const TroubleView& view) {
        return view.tries >= kMaxTries || view.in_a_row >= kMaxFaults
                 ? std::optional(Signal::give_up)
             : view.solved ? std::optional(Signal::go_on)
                           : std::nullopt;
    }
    /// The plan is finished.
    virtual void finish(const SessionView& session) = 0;
};

}  // namespace palpate::protocols
