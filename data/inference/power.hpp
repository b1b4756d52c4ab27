#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/protocol/protocol.hpp"
#include "data/plot/figure.hpp"

/// What a study can find, by many studies of simulated people.
namespace palpate::data {

/// One person of a simulated study.
struct PowerPerson {
    double trials = 0.0;         ///< under each friction
    double right_without = 0.0;  ///< right answers
    double right_with = 0.0;
    double expected = 0.0;  ///< chance of a right answer with friction, less that without
};

/// The person of a number (from 0) in a study of a number: always the same one. Asked from several
/// threads.
using PowerPeople = std::function<PowerPerson(std::size_t study, std::size_t number)>;

/// Of shares: a smaller true difference is none, and nothing that could be exaggerated.
inline constexpr double kNoEffect = 5e-3;

/// How studies are analysed, and how many are drawn.
struct PowerSpec {
    protocols::PrimaryTest test = protocols::PrimaryTest::paired_t;
    double alpha = 0.05;         ///< two-sided
    std::size_t studies = 1000;  ///< 2 or more
    std::size_t threads = 1;
};

/// A share over studies, or a mean, with its Monte-Carlo standard error.
struct MonteCarlo {
    double value = 0.0;
    double se = 0.0;

    friend bool operator==(const MonteCarlo&, const MonteCarlo&) = default;
};

/// What studies of so many people come to.
struct PowerPoint {
    std::size_t participants = 0;
    MonteCarlo power{};  ///< share of studies whose test is significant
    MonteCarlo
        width{};  ///< of the 95 % interval (Student's, over people) of the difference of shares
    MonteCarlo estimate{};  ///< the difference of shares, with friction less without
    /// Of significant studies: mean size of the difference by the true one's size, and the share
    /// that have the wrong sign (A. Gelman, J. Carlin, Perspect. Psychol. Sci. 9:641, 2014: type M
    /// and type S). Nothing without any, or without a true difference.
    std::optional<MonteCarlo> exaggeration{};
    std::optional<MonteCarlo> wrong_sign{};

    friend bool operator==(const PowerPoint&, const PowerPoint&) = default;
};

/// How many participants a power takes. Nothing: more than were looked for.
struct LeastPeople {
    double power = 0.0;
    std::optional<std::size_t> people{};
    std::optional<std::size_t> low{};
    std::optional<std::size_t> high{};
    /// Studies that tell this number to about one participant, by the power's growth there; nothing
    /// where these do.
    std::optional<std::size_t> studies{};

    friend bool operator==(const LeastPeople&, const LeastPeople&) = default;
};

/// Many studies of the same people-to-be: that of fewer participants is the beginning of that of
/// more.
class PowerStudies {
public:
    /// Asks for nobody yet.
    PowerStudies(const PowerSpec& spec, PowerPeople people);

    /// @param participants  2 or more. Any number of threads gives the same.
    [[nodiscard]] PowerPoint at(std::size_t participants);
    /// The least number of participants from 3 to `max` whose power is at least `wanted`, taken to
    /// grow with it, and which numbers Monte-Carlo error allows: the least whose power could be
    /// that high, and the least whose power must be, by the ends of Wilson's 95 % interval of the
    /// share of studies.
    [[nodiscard]] LeastPeople least(double wanted, std::size_t max);
    /// Mean of `expected` over all people drawn so far: the true difference of shares.
    [[nodiscard]] double truth() const;

private:
    PowerSpec spec_;
    PowerPeople people_;
    /// Studies of so many that found something.
    [[nodiscard]] double found(std::size_t participants);

    std::vector<std::vector<PowerPerson>> drawn_;  ///< by study
    std::map<std::size_t, double> found_;
};

/// "paired t of the share of right answers, within people"
[[nodiscard]] std::string_view title_of(protocols::PrimaryTest test);

/// A report on the power of a study.
struct PowerReport {
    std::string study{};
    std::string friction{};  ///< that of the effect ...
    std::string against{};   ///< ... and what it is compared with
    PowerSpec spec{};
    std::size_t null_studies = 0;
    std::size_t hands = 0;        ///< simulated people whose hands felt
    std::size_t felt_trials = 0;  ///< that they felt, once, of all conditions
    std::size_t trials = 0;       ///< of a person under each friction
    std::size_t planned = 0;      ///< participants, by the protocol
    std::string effect{};         ///< "-0.5 logit (sd 0.3 over people)"
    bool none = false;  ///< the effect is 0: what is found is type I error, and is not exaggerated
    double share_without = 0.0;        ///< mean chance of a right answer
    double true_difference = 0.0;      ///< of shares
    double people_sd = 0.0;            ///< of the log odds without friction, over people
    std::vector<PowerPoint> points{};  ///< by participants
    std::vector<PowerPoint> null{};  ///< the same without an effect; its power is the type I error
    std::vector<LeastPeople> least{};  ///< for powers in order
    std::size_t max = 0;
};

/// Tables for people, with the sentence for a pre-registration.
[[nodiscard]] std::string power_text(const PowerReport& report);
/// The same for programs.
[[nodiscard]] std::string power_json(const PowerReport& report);
/// Power and type I error over participants, with 95 % intervals of Wilson.
[[nodiscard]] Figure power_figure(const PowerReport& report);

/// Two-sided p of a test of the differences of people, as `palpate stats` has it: paired t,
/// sign-flip and signed ranks of the shares, the likelihood ratio of the mixed model (Laplace) by
/// chi-square of 1 df. 1 where it says nothing.
[[nodiscard]] double p_of(protocols::PrimaryTest test, const std::vector<PowerPerson>& people);

}  // namespace palpate::data
