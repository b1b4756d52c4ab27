#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/side_by_side.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/observer_file.hpp"
#include "data/inference/power.hpp"
#include "data/plot/figure.hpp"
#include "data/store/secret.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/simulated_session.hpp"

namespace palpate::ui {
namespace {

constexpr std::size_t kMax = 200;  ///< participants that are looked for

struct PowerOptions {
    std::string protocol;
    std::string effect;
    double effect_sd = 0.3;
    bool effect_sd_said = false;
    std::string participants = "8,12,16,24";
    std::string observer = "typical";
    std::string friction;
    std::string test;
    std::int64_t studies = 1000;
    std::int64_t null_studies = 0;
    std::int64_t hands = 6;
    std::int64_t threads = 0;
    std::optional<std::uint64_t> seed;
    std::string drawing;
    bool json = false;
};

/// How many are simulated, and how.
void declare_studies(CommandWords& words, PowerOptions& options) {
    words.add("--studies", options.studies, "So many simulated studies for each number")
        .within(10, 1'000'000);
    words
        .add("--null-studies", options.null_studies,
             "The same without an effect, for the type I error; 0: ten times --studies, with mixed "
             "as many")
        .within(0, 10'000'000)
        .with_default();
    words
        .add("--hands", options.hands,
             "People whose hands feel every trial of a session once; all studies are judged from "
             "these")
        .within(1, 1000);
    words
        .add("--threads", options.threads,
             "0: as many as there are processors for it. The numbers are the same")
        .within(0, 1024)
        .with_default();
    words.add("--seed", options.seed, "Instead of the protocol's");
    words.add("--svg", options.drawing, "The curve, as a drawing");
    words.add("--json", options.json, "For programs, to standard output");
}

void declare(CommandWords& words, PowerOptions& options) {
    words.add("PROTOCOL", options.protocol, "A protocol file, or the name of a shipped one")
        .required();
    words
        .add("--effect", options.effect,
             "What friction does to the log odds of a right answer, as -0.5; or observer: what the "
             "observer file says, in bias and in sensitivity")
        .required();
    words
        .add("--effect-sd", options.effect_sd,
             "How much people differ in that, a standard deviation in logit")
        .within(0.0, 5.0)
        .tells(options.effect_sd_said);
    words.add("--participants", options.participants, "For which numbers of them, from 2 to 200");
    words.add("--observer", options.observer, "Who they are: an observer file, or typical");
    words.add("--friction", options.friction,
              "Which one is compared with the least; without it the largest");
    words.add("--test", options.test, "Another primary test than that of the protocol's [analysis]")
        .among({protocols::kPrimaryTests.begin(), protocols::kPrimaryTests.end()});
    declare_studies(words, options);
}

std::vector<std::size_t> numbers_of(const std::string& text) {
    std::vector<std::size_t> numbers;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        const std::size_t number = parsed<std::size_t>(part).value_or(0);
        refuse_if(number < 2 || number > kMax,
                  "--participants {}: give numbers from 2 to {} with commas between, as 8,12,16,24",
                  text, kMax);
        numbers.push_back(number);
    }
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    refuse_if(numbers.empty(), "--participants is empty: give numbers, as 8,12,16,24");
    return numbers;
}

/// @return nothing: as the observer file says
std::optional<protocols::LogitEffect> effect_of(const PowerOptions& options) {
    if (options.effect == "observer") {
        refuse_if(options.effect_sd_said,
                  "--effect-sd is of an --effect in logits: with observer the observer file says "
                  "how much people differ");
        return std::nullopt;
    }
    char* end = nullptr;
    const double mean = std::strtod(options.effect.c_str(), &end);
    refuse_if(options.effect.empty() || *end != '\0' || !(std::fabs(mean) <= 10.0),
              "--effect {}: give a number of logits from -10 to 10, as -0.5, or observer",
              options.effect);
    return protocols::LogitEffect{.mean = mean, .sd = options.effect_sd};
}

/// The frictions that are compared: the least static one, and the one asked for or the largest.
protocols::FrictionPair pair_of(const protocols::Protocol& protocol, const std::string& name) {
    const auto& all = protocol.frictions;
    protocols::FrictionPair pair = protocols::primary_pair(protocol);
    if (!name.empty()) {
        const auto found = std::ranges::find(all, name, &protocols::FrictionSpec::name);
        refuse_if(found == all.end(), "--friction {}: {} has none of that name", name, protocol.id);
        pair.with = static_cast<std::size_t>(found - all.begin());
    }
    refuse_if(all.size() == 1, "{}: two frictions are needed, one to compare with the other",
              protocol.id);
    refuse_if(pair.with == pair.without,
              "{}: {} is what others are compared with, the least static friction: give --friction "
              "and another",
              protocol.id, all[pair.without].name);
    return pair;
}

data::PowerPeople people_of(const protocols::JudgedPeople& people, std::uint64_t seed) {
    return [&people, seed](std::size_t study, std::size_t number) {
        const protocols::JudgedPerson one = people.person(seed, study, number);
        return data::PowerPerson{.trials = static_cast<double>(one.trials),
                                 .right_without = static_cast<double>(one.right_without),
                                 .right_with = static_cast<double>(one.right_with),
                                 .expected = one.share_with - one.share_without};
    };
}

/// How often people are right without friction, and how much they differ in its log odds.
void describe_people(const protocols::JudgedPeople& people,
                     std::uint64_t seed,
                     data::PowerReport& report) {
    constexpr std::size_t kPeople = 500;
    double sum = 0.0;
    double logits = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < kPeople; ++i) {
        const double share = people.person(seed, 0, i).share_without;
        const double logit = std::log(share / (1.0 - share));
        sum += share;
        logits += logit;
        squares += logit * logit;
    }
    const double mean = logits / kPeople;
    report.share_without = sum / kPeople;
    report.people_sd = std::sqrt(std::max(0.0, squares / kPeople - mean * mean));
}

/// What is asked for, without numbers.
data::PowerReport report_of(const PowerOptions& options,
                            const protocols::Protocol& protocol,
                            const protocols::FrictionPair& pair,
                            const std::optional<protocols::LogitEffect>& effect) {
    data::PowerReport report{.study = protocol.id,
                             .friction = protocol.frictions[pair.with].name,
                             .against = protocol.frictions[pair.without].name,
                             .planned = protocol.participants,
                             .max = kMax};
    const auto named = std::ranges::find(protocols::kPrimaryTests, options.test);
    report.spec.test =
        options.test.empty()
            ? protocol.analysis.primary
            : static_cast<protocols::PrimaryTest>(named - protocols::kPrimaryTests.begin());
    report.spec.studies = static_cast<std::size_t>(options.studies);
    report.spec.threads =
        options.threads > 0 ? static_cast<std::size_t>(options.threads) : usable_processors();
    const bool mixed = report.spec.test == protocols::PrimaryTest::mixed;
    report.null_studies = options.null_studies > 0 ? static_cast<std::size_t>(options.null_studies)
                                                   : (mixed ? 1 : 10) * report.spec.studies;
    report.effect = effect
                      ? fmt::format("{:g} logit (sd {:g} over people)", effect->mean, effect->sd)
                      : fmt::format("what {} says of friction", options.observer);
    return report;
}

/// How many people it takes, and whether there is anything to find.
void add_truth(data::PowerStudies& studies, bool no_effect, data::PowerReport& report) {
    report.true_difference = studies.truth();
    report.none = no_effect || std::fabs(report.true_difference) < data::kNoEffect;
    if (report.none) {  // no number of people finds it
        for (data::PowerPoint& point : report.points) {
            point.exaggeration.reset();
            point.wrong_sign.reset();
        }
        return;
    }
    for (const double power : {0.8, 0.9}) {
        report.least.push_back(studies.least(power, kMax));
    }
}

/// The studies of people, and those of people without an effect.
void add_points(data::PowerPeople people,
                data::PowerPeople nobody,
                const std::vector<std::size_t>& participants,
                bool no_effect,
                data::PowerReport& report) {
    data::PowerSpec null_spec = report.spec;
    null_spec.studies = report.null_studies;
    data::PowerStudies studies(report.spec, std::move(people));
    data::PowerStudies null(null_spec, std::move(nobody));
    static_cast<void>(studies.at(participants.back()));  // the truth is known of all of them
    for (const std::size_t number : participants) {
        report.points.push_back(studies.at(number));
        report.null.push_back(null.at(number));
    }
    add_truth(studies, no_effect, report);
}

/// People who differ as much, and in the mean by nothing.
protocols::LogitEffect no_effect(const std::optional<protocols::LogitEffect>& effect,
                                 protocols::PrimaryTest test) {
    return {.mean = 0.0,
            .sd = effect ? effect->sd : 0.0,
            .in_shares = test != protocols::PrimaryTest::mixed};
}

int run(const PowerOptions& options) {
    const auto participants = numbers_of(options.participants);
    const auto effect = effect_of(options);
    const protocols::ObserverModel model = protocols::load_observer(options.observer);
    SimulatedStudy study{.study = load_study(options.protocol),
                         .seed = 0,
                         .secret = std::string(data::kDemoSecret),
                         .observer = model};
    const protocols::Protocol& protocol = study.study.protocol;
    protocols::require_judged(protocol);
    study.seed = options.seed.value_or(protocol.seed);
    const protocols::FrictionPair pair = pair_of(protocol, options.friction);
    require_writable(options.drawing, "<svg");
    data::PowerReport report = report_of(options, protocol, pair, effect);
    catch_signals();
    const std::vector<protocols::FeltTrial> hands =
        felt_hands(study, static_cast<std::size_t>(options.hands), report.spec.threads);
    report.hands = static_cast<std::size_t>(options.hands);
    report.felt_trials = hands.size();

    const protocols::JudgedPeople people(protocol, model, hands, pair, effect);
    const protocols::JudgedPeople nobody(protocol, model, hands, pair,
                                         no_effect(effect, report.spec.test));
    report.trials = people.person(study.seed, 0, 0).trials;
    describe_people(people, study.seed, report);
    add_points(people_of(people, study.seed), people_of(nobody, study.seed + 1), participants,
               effect && effect->mean == 0.0, report);
    if (!options.drawing.empty()) {
        write_whole(options.drawing, data::svg(power_figure(report)));
    }
    say("{}", options.json ? power_json(report) : power_text(report));
    return 0;
}

}  // namespace

Command power_command() {
    return make_command<PowerOptions>(
        "power",
        "What a protocol's primary test can find: power, type I error, how many people it takes",
        declare, run);
}

}  // namespace palpate::ui
