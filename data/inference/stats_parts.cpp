#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/inference/stats_report.hpp"

namespace palpate::data {
namespace {

/// Streams of PCG32: a person's permutations under a friction, and the samples of a simulated null.
constexpr std::uint64_t kPermutationStreams = std::uint64_t{1} << 32;
constexpr std::uint64_t kNullStreams = std::uint64_t{1} << 40;

using Taken = std::vector<const Trial*>;

std::optional<double> mean_of_trials(const Taken& trials,
                                     std::optional<double> Trial::*member,
                                     bool logarithm) {
    double sum = 0.0;
    double n = 0.0;
    for (const Trial* one : trials) {
        if (const auto& value = one->*member) {
            sum += logarithm ? std::log(*value) : *value;
            n += 1.0;
        }
    }
    return n > 0.0 ? std::optional(sum / n) : std::nullopt;
}

bool is_signal(const StatsReport& report, const Trial& trial) {
    return std::ranges::find(report.options.signals, report.table.shapes[trial.shape]) !=
           report.options.signals.end();
}

/// Of yes/no with signals, where what is right is yes for these and no for all others.
std::int64_t false_alarms(const PersonCell& cell) {
    return cell.n - cell.signals - (cell.k - cell.hits);
}

void add_sensitivity(const StatsReport& report, const Taken& trials, PersonCell& cell) {
    if (!report.yes_no && report.table.alternatives < 2) {
        return;  // one picture alone is compared with nothing
    }
    if (!report.yes_no) {
        cell.d_prime =
            d_prime(cell.k, cell.n, static_cast<std::int64_t>(report.table.alternatives));
        return;
    }
    for (const Trial* one : trials) {
        const bool yes = report.table.responses[one->response] == "yes";
        const bool signal = is_signal(report, *one);
        cell.signals += signal ? 1 : 0;
        cell.hits += signal && yes ? 1 : 0;
    }
    if (report.right_known && cell.signals > 0 && cell.signals < cell.n) {
        const YesNo both =
            yes_no(cell.hits, cell.signals, false_alarms(cell), cell.n - cell.signals);
        cell.d_prime = both.d_prime;
        cell.criterion = both.criterion;
    }
}

PersonCell person_cell(const StatsReport& report, const Taken& trials, std::uint64_t stream) {
    PersonCell cell{.n = static_cast<std::int64_t>(trials.size())};
    if (trials.empty()) {
        return cell;
    }
    std::vector<std::size_t> shapes;
    std::vector<std::size_t> responses;
    for (const Trial* one : trials) {
        cell.k += hit(report, *one) ? 1 : 0;
        shapes.push_back(one->shape);
        responses.push_back(one->response);
    }
    cell.wilson = wilson(cell.k, cell.n);
    cell.clopper_pearson = clopper_pearson(cell.k, cell.n);
    add_sensitivity(report, trials, cell);
    cell.bits =
        transmitted(shapes, responses, report.options.permutations, report.options.seed, stream);
    cell.log_rt = mean_of_trials(trials, &Trial::rt_s, true);
    cell.log_explore = mean_of_trials(trials, &Trial::explore_s, true);
    cell.confidence = mean_of_trials(trials, &Trial::confidence, false);
    return cell;
}

/// d' and criterion of all frictions, corrected alike.
void add_alike(const StatsReport& report, PersonStats& person) {
    std::int64_t n = 0;
    std::int64_t signals = 0;
    std::int64_t noises = 0;
    const auto least = [](std::int64_t& one, std::int64_t other) {
        one = one == 0 ? other : std::min(one, other);
    };
    for (const PersonCell& cell : person.cells) {
        if (cell.d_prime) {
            least(n, cell.n);
            least(signals, cell.signals);
            least(noises, cell.n - cell.signals);
        }
    }
    for (PersonCell& cell : person.cells) {
        if (!cell.d_prime) {
            continue;
        }
        if (report.yes_no) {
            const YesNo both = yes_no(cell.hits, cell.signals, false_alarms(cell),
                                      cell.n - cell.signals, signals, noises);
            cell.alike_d_prime = both.d_prime;
            cell.alike_criterion = both.criterion;
        } else {
            const auto alternatives = static_cast<std::int64_t>(report.table.alternatives);
            cell.alike_d_prime =
                cell.n == n ? cell.d_prime : d_prime(cell.k, cell.n, alternatives, n);
        }
    }
}

/// Of all frictions together: what they do is balanced over the trials.
void add_trends(const StatsReport& report, const Taken& trials, PersonStats& person) {
    std::vector<Moment> answers;
    std::vector<Moment> times;
    for (const Trial* one : trials) {
        Moment moment{.trial = static_cast<double>(one->number), .since_break = one->since_break};
        moment.value = hit(report, *one) ? 1.0 : 0.0;
        answers.push_back(moment);
        if (one->rt_s) {
            moment.value = std::log(*one->rt_s);
            times.push_back(moment);
        }
    }
    person.answers = trend(answers);
    person.log_rt = trend(times);
}

void add_confidence(const StatsReport& report, const Taken& trials, PersonStats& person) {
    std::vector<double> right;
    std::vector<double> wrong;
    double over = 0.0;
    double squares = 0.0;
    for (const Trial* one : trials) {
        if (one->confidence) {
            const double off = *one->confidence - (hit(report, *one) ? 1.0 : 0.0);
            (hit(report, *one) ? right : wrong).push_back(*one->confidence);
            over += off;
            squares += off * off;
        }
    }
    person.confidence_area = type_2_area(right, wrong);
    if (const auto n = static_cast<double>(right.size() + wrong.size());
        report.probability && n > 0.0) {
        person.overconfidence = over / n;
        person.brier = squares / n;
    }
}

std::vector<ConfidenceLevel> levels_of(const StatsReport& report, const std::vector<Taken>& all) {
    struct Used {
        double n = 0.0;
        double right = 0.0;
    };
    std::map<double, std::vector<Used>> levels;
    for (std::size_t person = 0; person < all.size(); ++person) {
        for (const Trial* one : all[person]) {
            if (one->confidence) {
                auto& used = levels[*one->confidence];
                used.resize(all.size());
                used[person].n += 1.0;
                used[person].right += hit(report, *one) ? 1.0 : 0.0;
            }
        }
    }
    std::vector<ConfidenceLevel> found;
    constexpr std::size_t kMaxLevels = 12;  // of more the table would be a scatter of answers
    if (levels.size() > kMaxLevels) {
        return found;
    }
    for (const auto& [level, used] : levels) {
        std::vector<double> shares;
        double n = 0.0;
        for (const Used& one : used) {
            n += one.n;
            if (one.n > 0.0) {
                shares.push_back(one.right / one.n);
            }
        }
        found.push_back({.level = level,
                         .n = static_cast<std::int64_t>(n),
                         .share = mean_share_over_people(shares)});
    }
    return found;
}

std::optional<TwoCounts> two_counts(const PersonStats& person, std::size_t friction) {
    const PersonCell& first = person.cells[0];
    const PersonCell& other = person.cells[friction];
    if (first.n + other.n == 0) {
        return std::nullopt;
    }
    return TwoCounts{.n = {static_cast<double>(first.n), static_cast<double>(other.n)},
                     .k = {static_cast<double>(first.k), static_cast<double>(other.k)}};
}

void add_mixed(const StatsReport& report, StatsPart& part) {
    for (std::size_t friction = 1; friction < report.table.frictions.size(); ++friction) {
        std::vector<TwoCounts> people;
        std::array<double, 2> n{};
        for (const PersonStats& person : part.people) {
            if (const auto counts = two_counts(person, friction)) {
                people.push_back(*counts);
                n[0] += counts->n[0];
                n[1] += counts->n[1];
            }
        }
        if (people.size() < 2 || n[0] == 0.0 || n[1] == 0.0) {
            continue;
        }
        const int nodes = report.options.nodes;
        MixedStats made{.friction = friction, .people = people.size()};
        made.laplace = fit_mixed(people, {});
        made.laplace_null = fit_mixed(people, {.effect = false});
        made.laplace_intercept = fit_mixed(people, {.slope = false});
        made.quadrature = fit_mixed(people, {.nodes = nodes}, &made.laplace);
        made.quadrature_null =
            fit_mixed(people, {.effect = false, .nodes = nodes}, &made.laplace_null);
        if (report.options.simulations > 0) {
            made.simulated = simulate_null(
                people, made.laplace_null, likelihood_ratio(made.laplace, made.laplace_null),
                report.options.simulations, report.options.seed, kNullStreams * friction);
        }
        part.mixed.push_back(made);
    }
}

}  // namespace

bool hit(const StatsReport& report, const Trial& trial) {
    const std::string& response = report.table.responses[trial.response];
    if (!report.yes_no) {
        return response == report.table.shapes[trial.shape];
    }
    const bool yes = response == "yes";
    return report.right_known ? yes == is_signal(report, trial) : yes;
}

StatsPart part_of(const StatsReport& report, const std::function<bool(const Trial&)>& takes) {
    const TrialTable& table = report.table;
    std::vector<Taken> of_all(table.subjects.size());
    StatsPart part;
    for (const Trial& one : table.trials) {
        if (takes(one)) {
            of_all[one.subject].push_back(&one);
            ++part.trials;
        }
    }
    std::vector<Taken> kept;
    for (std::size_t subject = 0; subject < of_all.size(); ++subject) {
        const Taken& trials = of_all[subject];
        if (trials.empty()) {
            continue;
        }
        PersonStats& person = part.people.emplace_back();
        person.subject = table.subjects[subject];
        for (std::size_t friction = 0; friction < table.frictions.size(); ++friction) {
            Taken some;
            std::ranges::copy_if(trials, std::back_inserter(some),
                                 [&](const Trial* one) { return one->friction == friction; });
            person.cells.push_back(person_cell(
                report, some, kPermutationStreams + subject * table.frictions.size() + friction));
        }
        add_alike(report, person);
        add_trends(report, trials, person);
        if (report.right_known) {
            add_confidence(report, trials, person);
        }
        kept.push_back(trials);
    }
    if (report.right_known) {
        part.levels = levels_of(report, kept);
    }
    add_measures(report, part);
    add_mixed(report, part);
    add_tests(report, part);
    return part;
}

std::vector<std::string> warnings_of(const MixedStats& mixed) {
    std::vector<std::string> all;
    const auto add = [&](const char* method, const MixedFit& fit, const MixedFit& null) {
        constexpr double kFar = 10.0;  // logits: half of the people always right, half never
        if (fit.unbounded) {
            all.push_back(fmt::format(
                "{}: {} (a condition has answers of one kind alone): estimate, se and spread of it "
                "say nothing, {}",
                method,
                fit.intercept_unbounded ? "intercept and effect have no end"
                                        : "the effect has no end",
                null.sd_slope > kFar
                    ? "and without it the spread has no end: the likelihood ratio is rough"
                    : "the likelihood ratio holds"));
        }
        if (fit.singular) {
            all.push_back(fmt::format(
                "{}: the fit is singular: the spread of intercepts and effects over people has "
                "lost a dimension (a variance of 0, or a correlation of -1 or 1); too few people "
                "or trials for this model, and its standard errors are too small",
                method));
        }
        if (!fit.converged) {
            all.push_back(
                fmt::format("{}: no maximum was found: do not use these numbers", method));
        }
    };
    add("Laplace", mixed.laplace, mixed.laplace_null);
    add("Gauss-Hermite", mixed.quadrature, mixed.quadrature_null);
    if (mixed.people < 6) {
        all.push_back(fmt::format("{}: a spread over people is hardly known from fewer than 6",
                                  counted(mixed.people, "person", "people")));
    }
    return all;
}

}  // namespace palpate::data
