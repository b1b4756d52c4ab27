#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/friction/laws/law_spec.hpp"
#include "engine/geometry/vec.hpp"
#include "stimuli/free_outline.hpp"

/// The experiment as a value: what a protocol file says, after every check. SI units here; the file
/// carries its units in the key names. Default members are the default study.
namespace palpate::protocols {

/// One object: two curves of the same signed curvature on the chords of OutlineSpec, or a free
/// form. Either is then placed: made larger, turned about the origin, moved.
struct ObjectSpec {
    std::string name;         ///< e.g. "convex_10"; unique, [a-z0-9_]
    double curvature = 0.0;   ///< 1/m: > 0 convex, 0 straight, < 0 concave; not of a free form
    bool pictured = true;     ///< false: a catch object, felt but never among the pictures
    double size = 1.0;        ///< factor, > 0; curvatures are divided by it
    engine::Vec2 offset{};    ///< m
    double turn = 0.0;        ///< rad, anticlockwise
    double compliance = 0.0;  ///< m/N at the vertex of two curves, 0: rigid; see SoftShape
    std::vector<stimuli::Segment> segments{};  ///< of a free form, closed; none: two curves
    /// Of a study of surfaces: 1/m along y, where `curvature` is that along x; > 0 bulges up.
    double cross_curvature = 0.0;

    /// Where and how large its outline stands, m and rad.
    [[nodiscard]] stimuli::Pose pose() const noexcept { return {size, offset, turn}; }

    friend bool operator==(const ObjectSpec&, const ObjectSpec&) = default;
};

/// One friction set. law "frictionless" has no coefficients; "gos" is the god-object spring law,
/// "coulomb" the same with one coefficient; the others are those of engine/friction/laws.
struct FrictionSpec {
    std::string name;  ///< e.g. "off", "on"; unique
    std::string law = "frictionless";
    double mu_s = 0.0;      ///< static coefficient, mu_d <= mu_s; of a law without one: mu_d
    double mu_d = 0.0;      ///< dynamic coefficient
    double tau_slip = 0.0;  ///< s, relaxation to mu_d while slipping; 0: a sharp drop
    double tau_heal = 0.0;  ///< s, recovery to mu_s while stuck
    engine::LawSpec own{};  ///< what a law of its own needs besides; its kind follows from `law`

    friend bool operator==(const FrictionSpec&, const FrictionSpec&) = default;
};

/// Where the chords run: A-V and V-B joined at the vertex V, closed by the base line B-A. m.
struct OutlineSpec {
    engine::Vec2 a{-0.040, 0.0};
    engine::Vec2 vertex{0.0, 0.040};
    engine::Vec2 b{0.040, 0.0};

    friend bool operator==(const OutlineSpec&, const OutlineSpec&) = default;
};

/// Present in a study of surfaces: every object is a square patch in space, curved along x and
/// along y (stimuli/surface_patch.hpp), felt on a machine of three axes.
struct SurfaceSpec {
    double size = 0.060;          ///< side of the patch, m
    double start_height = 0.030;  ///< of the start pose above the middle of every patch, m

    friend bool operator==(const SurfaceSpec&, const SurfaceSpec&) = default;
};

/// What a real session of the study must be run on.
enum class DeviceClass : std::uint8_t { any, haply, comedi, mouse, board };

/// What the hand meets.
struct ApparatusSpec {
    DeviceClass device = DeviceClass::any;
    double rate_hz = 1000.0;         ///< servo rate, 1/s, 1000 to 10000
    double stiffness = 1000.0;       ///< K, N/m
    double damping = 0.0;            ///< B of the contact, N s/m; 0: a spring alone
    double force_limit = 10.0;       ///< N, the command is scaled to this, direction kept
    double force_ramp = 0.2;         ///< s, at enable and disable
    double vertex_slew = 0.2;        ///< m/s, 0: none
    double vertex_radius = 0.003;    ///< m of travel budget per radian of a vertex fan
    engine::Vec2 start{0.0, 0.060};  ///< start pose of the handle, m
    double start_radius = 0.005;     ///< m from there, within which a trial may begin; 0: anywhere

    friend bool operator==(const ApparatusSpec&, const ApparatusSpec&) = default;
};

/// Limits of the safety chain beyond the force limit and its ramp.
struct SafetySpec {
    double slew_limit = 2000.0;   ///< N/s, how fast the force may change
    double speed_limit = 1.5;     ///< m/s of HIP; faster trips
    std::size_t late_run = 20;    ///< late ticks in a row that trip, 0: never
    std::size_t late_share = 50;  ///< late ticks among the last 100 that trip, 0: never
    double energy_limit = 0.1;    ///< J that the rendering may give beyond what it takes
    bool dead_man = false;        ///< force only while the participant holds the dead-man switch

    friend bool operator==(const SafetySpec&, const SafetySpec&) = default;
};

/// When an answered trial does not count and is run again at a random later place of its block.
struct InvalidSpec {
    double late_share = 0.001;  ///< of its ticks may be late, 0..1; 1: any. Not of simulated hands
    double stale_share = 1.0;   ///< of its readings may be no new ones, 0..1; 1: any
    double contact_min = 1.0;   ///< s of contact, 0: none needed
    double path_min = 0.160;    ///< m of path of HIP, 0: none needed
    std::size_t max_requeues = 10;  ///< times that a position is run again, faults too; 0: never

    friend bool operator==(const InvalidSpec&, const InvalidSpec&) = default;
};

/// Who is left out of the analysis: written down before anybody ran, applied by `palpate summary`,
/// which shows both ways. All default: nobody is.
struct ExclusionSpec {
    double catch_correct_min = 0.0;  ///< share of catch trials answered with the outermost picture
    double share_correct_min = 0.0;  ///< of main trials
    double timed_out_share_max = 1.0;  ///< of main trials
    double invalid_share_max = 1.0;    ///< of answers in main trials
    bool sessions_finished = false;    ///< whoever has a session that is not is left out

    friend bool operator==(const ExclusionSpec&, const ExclusionSpec&) = default;
};

/// By which test of the effect of friction, within people, a study stands or falls; `palpate stats`
/// has them all.
enum class PrimaryTest : std::uint8_t {
    paired_t,     ///< Student's, of the differences of shares
    sign_flip,    ///< exact, of their mean
    signed_rank,  ///< Wilcoxon's
    mixed,        ///< likelihood ratio of the logistic mixed model
};

/// What is asked of the data, written down before anybody ran.
struct AnalysisSpec {
    PrimaryTest primary = PrimaryTest::paired_t;

    friend bool operator==(const AnalysisSpec&, const AnalysisSpec&) = default;
};

/// What an order of the main trials must keep.
enum class OrderRule : std::uint8_t {
    random,       ///< any order within the run limits, each as likely as the others
    first_order,  ///< every condition follows every condition once: repetitions = conditions
};

/// How the frictions of the main trials come.
enum class FrictionBlocks : std::uint8_t {
    interleaved,  ///< all of them in every block
    abba,         ///< one a block, in an order and back again: A B, B A
    blocked,      ///< one a block, always in the same order: A B, A B
};

/// [design]: how often what comes, and in which order.
struct DesignSpec {
    std::size_t repetitions = 10;          ///< of each condition in the main phase, >= 1
    std::size_t max_run_object = 2;        ///< same object in a row, 0: no limit
    std::size_t max_run_friction = 3;      ///< same friction in a row, 0: no limit
    std::size_t practice_repetitions = 1;  ///< of each condition before the main phase, 0: none
    std::size_t catch_trials = 4;          ///< placed at random among the main trials
    std::size_t break_every = 20;          ///< main-phase trials between breaks, 0: none
    std::size_t blocks = 1;  ///< of the main trials, each balanced; a divisor of repetitions
    OrderRule order = OrderRule::random;
    FrictionBlocks friction_blocks = FrictionBlocks::interleaved;

    friend bool operator==(const DesignSpec&, const DesignSpec&) = default;
};

/// [timing]: how long a trial's steps may take.
struct TimingSpec {
    double explore_min = 2.0;       ///< s, done is ignored before
    double explore_prompt = 30.0;   ///< s, then the screen asks for an answer
    double explore_timeout = 45.0;  ///< s, then the choice is asked for
    double break_min = 30.0;        ///< s
    double gap = 1.5;               ///< s between the choice and the next ready screen
    double guard = 0.25;            ///< s: a press so soon after a screen appeared is no answer
    double answer_timeout = 0.0;    ///< s, then a question ends unanswered; 0: it waits

    friend bool operator==(const TimingSpec&, const TimingSpec&) = default;
};

/// What the participant is asked after feeling.
enum class ResponseKind : std::uint8_t {
    identification,  ///< which of the pictured objects?
    two_interval,    ///< two things are felt: which of them, the first or the second?
    yes_no,
    rating,  ///< a level of a scale
};

/// When the participant learns whether an answer was right.
enum class Feedback : std::uint8_t { none, practice, all };

/// [response]: what is asked after the exploration.
struct ResponseSpec {
    ResponseKind kind = ResponseKind::identification;
    std::string question;    ///< empty: the screen's own sentence
    std::size_t levels = 7;  ///< of a rating, 2..9
    std::string low;         ///< label of a rating's first level, or of no; empty: the screen's own
    std::string high;        ///< label of a rating's last level, or of yes
    bool confidence = false;  ///< asked for after the answer, 1..4
    bool confirm = false;  ///< an answer can be changed until it is confirmed, the confidence too
    Feedback feedback = Feedback::none;  ///< of answers that can be right or wrong

    friend bool operator==(const ResponseSpec&, const ResponseSpec&) = default;
};

/// What an adaptive session varies from trial to trial.
enum class Varies : std::uint8_t {
    curvature,   ///< of the object's curves, 1/m
    mu,          ///< mu_s of a friction; its mu_d keeps its share of it
    compliance,  ///< of the object, mm/N as the rule counts
};

/// How the number that a rule chooses becomes what is felt.
enum class StimulusAs : std::uint8_t { value, log10 };  ///< log10: 10 to that power is felt

struct ProcedureSpec;  // protocols/procedure/procedure.hpp

/// How to choose, ready to begin.
struct RuleSpec {
    /// The canonical text of the procedure file that says the same, its name in hashes and in
    /// files.
    std::string text;
    std::shared_ptr<const ProcedureSpec>
        spec;  ///< what the text says; never none in a read protocol

    friend bool operator==(const RuleSpec& a, const RuleSpec& b) { return a.text == b.text; }
};

/// What is known of a rule before it starts.
struct RuleFacts {
    std::size_t trials = 0;  ///< it ends after so many, whatever is answered
    double lowest = 0.0;     ///< it never chooses less
    double highest = 0.0;    ///< nor more
    std::size_t outcomes = 2;
    std::string lowest_key{};   ///< which key says `lowest`, as in "staircase.2.lowest"
    std::string highest_key{};  ///< and `highest`
    /// An outcome of 1 is more likely than not wherever it stays: what is chosen is the greater
    /// one.
    bool one_sided = false;

    friend bool operator==(const RuleFacts&, const RuleFacts&) = default;
};

/// A rule that chooses what is felt next, by the answers so far: the table [procedure], and what
/// follows from the rule and is not written.
struct AdaptiveSpec : RuleFacts {
    Varies varies = Varies::curvature;
    StimulusAs stimulus_as = StimulusAs::value;
    std::string object;  ///< felt in every interval; its curvature is that of the standard
    std::size_t practice_trials = 0;   ///< before the others, in turn of all runs
    double practice_stimulus = 0.0;    ///< of all of them, as the rule counts
    bool practice_balanced = false;    ///< one half of every run's in each interval; else drawn
    std::size_t max_run = 0;           ///< trials of the same run in a row, 0: no limit
    std::size_t max_run_interval = 0;  ///< comparisons in the same interval in a row, 0: no limit
    RuleSpec rule;

    friend bool operator==(const AdaptiveSpec&, const AdaptiveSpec&) = default;
};

/// The rule of [procedure] runs once for each of these, with answers of its own; the runs' trials
/// are interleaved.
struct RunSpec {
    std::string name;
    std::string friction;           ///< of the comparison, whose stimulus the rule chooses
    std::string standard_friction;  ///< of the other interval; empty: the same as it stands

    friend bool operator==(const RunSpec&, const RunSpec&) = default;
};

/// The simulated observer of demos and simulations.
struct ObserverSpec {
    double noise = 2.62;        ///< 1/m, standard deviation of the curvature percept
    double lapse = 0.02;        ///< share of answers drawn at random, 0..1
    double force_weight = 0.5;  ///< weight of the force cue against the position cue, 0..1
    double bias_per_mu = 0.0;   ///< 1/m added to the percept per unit of felt friction coefficient
    double noise_mu = 0.1;      ///< standard deviation of the percept of the friction coefficient
    /// Of the percept of softness, its decadic logarithm: 0.04 are 10 %.
    double noise_softness = 0.04;

    friend bool operator==(const ObserverSpec&, const ObserverSpec&) = default;
};

/// Noise on the headphones, so that nobody hears the motors.
enum class Noise : std::uint8_t { none, pink };

/// [masking]: what is heard meanwhile.
struct MaskingSpec {
    Noise noise = Noise::none;
    double level_db = -30.0;  ///< root mean square against full scale, -60 to 0

    friend bool operator==(const MaskingSpec&, const MaskingSpec&) = default;
};

/// Of the participant's screen.
enum class Language : std::uint8_t { en, tr };

inline constexpr std::size_t kLanguageCount = 2;

/// Sentences shown instead of the screen's own, in one language; empty: the screen's own. A line
/// break begins a new paragraph.
struct InstructionTexts {
    std::string welcome;  ///< before the first trial: what the study is about to ask
    std::string ready;    ///< before each trial: what to do now
    std::string explore;  ///< while an object is felt: how to go about it
    std::string choose;   ///< the question above the answers
    std::string rest;     ///< in a break; the key is "break"
    std::string end;      ///< after the last trial

    friend bool operator==(const InstructionTexts&, const InstructionTexts&) = default;
};

/// Of the participants that are asked for.
enum class Handedness : std::uint8_t { right, left, any };

/// Whether whoever runs a session may see what is felt while it runs.
enum class Reveal : std::uint8_t { ask, never };

/// An experiment as its file describes it, SI.
struct Protocol {
    std::string id = "shape_friction";  ///< [a-z0-9_]+, names the study in the database
    std::string title;
    std::uint64_t seed = 0;         ///< the one recorded study seed
    std::size_t participants = 12;  ///< planned
    bool consent_required = false;  ///< no real session without a noted consent
    Handedness handedness = Handedness::right;
    Reveal reveal = Reveal::ask;
    Language language = Language::en;
    std::vector<ObjectSpec> objects;
    OutlineSpec outline{};
    std::optional<SurfaceSpec> surface{};  ///< none: objects in the plane
    std::vector<FrictionSpec> frictions;
    ApparatusSpec apparatus{};
    SafetySpec safety{};
    InvalidSpec invalid{};
    ExclusionSpec exclusion{};
    AnalysisSpec analysis{};
    DesignSpec design{};
    TimingSpec timing{};
    ResponseSpec response{};
    std::optional<AdaptiveSpec> procedure;  ///< none: the factorial design of [design]
    std::vector<RunSpec> runs;              ///< of the procedure
    ObserverSpec observer{};
    MaskingSpec masking{};
    std::array<InstructionTexts, kLanguageCount> instructions{};  ///< by Language

    friend bool operator==(const Protocol&, const Protocol&) = default;
};

/// The strongest damper that a contact may render, N s/m: that of the apparatus along the normal,
/// or a friction's along the surface. The device has to give as much on top of what springs need
/// (engine/safety/passivity.hpp).
[[nodiscard]] inline double contact_damping(const Protocol& protocol) noexcept {
    double damping = std::fabs(protocol.apparatus.damping);
    for (const FrictionSpec& friction : protocol.frictions) {
        damping = std::max(damping, friction.own.viscosity + friction.own.bristle_damping);
    }
    return damping;
}

}  // namespace palpate::protocols
