#include "data/inference/power.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "engine/base/side_by_side.hpp"
#include "data/inference/mixed_logit.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/paired.hpp"

namespace palpate::data {
namespace {

using protocols::PrimaryTest;

std::vector<double> differences_of(std::span<const PowerPerson> people) {
    std::vector<double> differences;
    for (const PowerPerson& one : people) {
        differences.push_back((one.right_with - one.right_without) / one.trials);
    }
    return differences;
}

/// Differences are whole numbers of one unit: sign_flip() of them, in people times answers.
double sign_flip_of_counts(std::span<const PowerPerson> people) {
    std::vector<std::size_t> sizes;
    std::size_t above = 0;
    for (const PowerPerson& one : people) {
        const double difference = one.right_with - one.right_without;
        sizes.push_back(static_cast<std::size_t>(std::lround(std::fabs(difference))));
        above += difference > 0.0 ? sizes.back() : 0;
    }
    return signed_sums_p(sizes, above);
}

double mixed_p(std::span<const PowerPerson> people) {
    std::vector<TwoCounts> counts;
    for (const PowerPerson& one : people) {
        counts.push_back({.n = {one.trials, one.trials}, .k = {one.right_without, one.right_with}});
    }
    const MixedFit full = fit_mixed(counts, {.errors = false});
    const MixedFit less = fit_mixed(counts, {.effect = false, .errors = false});
    return chi_square_p(likelihood_ratio(full, less), 1);
}

MonteCarlo share_of(double some, double all) {
    const double share = some / all;
    return {share, std::sqrt(share * (1.0 - share) / all)};
}

MonteCarlo mean_of(const std::vector<double>& values) {
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    const auto n = static_cast<double>(values.size());
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - sum / n) * (value - sum / n);
    }
    return {sum / n, n > 1.0 ? std::sqrt(squares / (n - 1.0) / n) : 0.0};
}

}  // namespace

double p_of(PrimaryTest test, const std::vector<PowerPerson>& people) {
    switch (test) {
        case PrimaryTest::paired_t: {
            const auto t = paired_t(differences_of(people), 1.0);
            return t ? t->p : 1.0;
        }
        case PrimaryTest::sign_flip:
            return sign_flip_of_counts(people);
        case PrimaryTest::signed_rank:
            return signed_rank(differences_of(people)).p;
        case PrimaryTest::mixed:
            break;
    }
    return mixed_p(people);
}

PowerStudies::PowerStudies(const PowerSpec& spec, PowerPeople people)
    : spec_(spec), people_(std::move(people)), drawn_(spec.studies) {}

PowerPoint PowerStudies::at(std::size_t participants) {
    std::vector<double> ps(spec_.studies);
    std::vector<double> means(spec_.studies);
    std::vector<double> widths(spec_.studies);
    for_each_number(spec_.threads, spec_.studies, [&](std::size_t study) {
        std::vector<PowerPerson>& people = drawn_[study];
        while (people.size() < participants) {
            people.push_back(people_(study, people.size()));
        }
        const std::vector<PowerPerson> these(
            people.begin(), people.begin() + static_cast<std::ptrdiff_t>(participants));
        const PeopleMean mean = mean_over_people(differences_of(these), 1.0);
        ps[study] = p_of(spec_.test, these);
        means[study] = mean.mean;
        widths[study] = mean.interval ? mean.interval->high - mean.interval->low : 0.0;
    });
    PowerPoint point{.participants = participants};
    const double true_difference = truth();
    std::vector<double> sizes;
    double wrong = 0.0;
    for (std::size_t study = 0; study < spec_.studies; ++study) {
        if (ps[study] < spec_.alpha) {
            sizes.push_back(std::fabs(means[study] / true_difference));
            wrong += means[study] * true_difference < 0.0 ? 1.0 : 0.0;
        }
    }
    const auto found = static_cast<double>(sizes.size());
    point.power = share_of(found, static_cast<double>(spec_.studies));
    point.width = mean_of(widths);
    point.estimate = mean_of(means);
    if (found > 0.0 && std::fabs(true_difference) > kNoEffect) {
        point.exaggeration = mean_of(sizes);
        point.wrong_sign = share_of(wrong, found);
    }
    return point;
}

double PowerStudies::found(std::size_t participants) {
    const auto [place, is_new] = found_.try_emplace(participants);
    if (is_new) {
        place->second = at(participants).power.value * static_cast<double>(spec_.studies);
    }
    return place->second;
}

LeastPeople PowerStudies::least(double wanted, std::size_t max) {
    const auto n = static_cast<std::int64_t>(spec_.studies);
    const auto share = [&](std::size_t participants) {
        return found(participants) / static_cast<double>(n);
    };
    const auto ends = [&](std::size_t participants) {
        return wilson(std::llround(found(participants)), n);
    };
    const auto search = [&](const auto& enough) -> std::optional<std::size_t> {
        std::size_t low = 2;  // its power is not enough, as far as that is known yet
        std::size_t high = std::min<std::size_t>(6, max);
        while (!enough(high)) {
            if (high == max) {
                return std::nullopt;
            }
            low = high;
            high = std::min(2 * high, max);
        }
        while (high - low > 1) {
            const std::size_t middle = (low + high) / 2;
            (enough(middle) ? high : low) = middle;
        }
        return high == 3 && enough(2) ? 2 : high;
    };
    LeastPeople least_people{.power = wanted};
    least_people.people = search([&](std::size_t people) { return share(people) >= wanted; });
    least_people.low = search([&](std::size_t people) { return ends(people).high >= wanted; });
    least_people.high = search([&](std::size_t people) { return ends(people).low >= wanted; });
    if (!least_people.people || !least_people.low ||
        (least_people.high && *least_people.high - *least_people.low <= 2)) {
        return least_people;
    }
    // A person more raises the power by so much near there: 1.96 standard errors are to be as much.
    const std::size_t right = least_people.high.value_or(max);
    const std::size_t left = std::min(*least_people.low, right - 1);
    const double growth = (share(right) - share(left)) / static_cast<double>(right - left);
    if (growth > 0.0) {
        const double studies = wanted * (1.0 - wanted) * std::pow(kNormal95 / growth, 2.0);
        const double step = std::pow(10.0, std::floor(std::log10(studies)));
        least_people.studies = static_cast<std::size_t>(std::ceil(studies / step) * step);
        if (*least_people.studies <= spec_.studies) {
            least_people.studies.reset();
        }
    }
    return least_people;
}

double PowerStudies::truth() const {
    double sum = 0.0;
    double people = 0.0;
    for (const auto& study : drawn_) {
        for (const PowerPerson& one : study) {
            sum += one.expected;
            people += 1.0;
        }
    }
    return people > 0.0 ? sum / people : 0.0;
}

}  // namespace palpate::data
