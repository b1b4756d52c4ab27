#include "protocols/procedure/grid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

std::vector<std::string> parameter_names(LapseForm form, SlopeAs slope_as, bool tilted) {
    std::vector<std::string> names;
    names.reserve(5);
    names.emplace_back("threshold");
    if (tilted) {
        names.emplace_back("tilt");
    }
    names.emplace_back(kSlopeWords.at(static_cast<std::size_t>(slope_as)));
    if (form != LapseForm::two_sided) {
        names.emplace_back("guess");
    }
    names.emplace_back("lapse");
    return names;
}

OutcomeModel two_outcomes(Family family, LapseForm form, SlopeAs slope_as, bool tilted) {
    OutcomeModel model;
    model.stimulus = {"stimulus"};
    if (tilted) {
        model.stimulus.emplace_back("covariate");
    }
    model.parameters = parameter_names(form, slope_as, tilted);
    model.chances = [=](std::span<const double> x, std::span<const double> s,
                        std::span<double> chances) {
        PsychometricFunction f{.family = family, .form = form, .threshold = s[0]};
        std::size_t next = 1;
        if (tilted) {
            f.threshold += s[next++] * x[1];
        }
        f.slope = slope_of(slope_as, s[next++]);
        f.guess = form == LapseForm::two_sided ? 0.0 : s[next++];
        f.lapse = s[next];
        check(f);
        chances[1] = probability(f, x[0]);
        chances[0] = 1.0 - chances[1];
    };
    model.same = fmt::format("{} {} {} {}", static_cast<int>(family), static_cast<int>(form),
                             static_cast<int>(slope_as), tilted);
    return model;
}

/// How much of a percept's distribution lies on either side of a criterion.
struct Sides {
    double below = 0.0;
    double above = 1.0;
};

Sides sides_of(double z) {
    const double tail = normal_cdf(-std::fabs(z));
    return z <= 0.0 ? Sides{tail, 1.0 - tail} : Sides{1.0 - tail, tail};
}

/// Share between two criteria, taken in the tail where the difference loses no digits.
double between(const Sides& left, const Sides& right) {
    return left.below > 0.5 ? left.above - right.above : right.below - left.below;
}

/// Half-way between neighbours.
std::vector<double> criteria_between(const std::vector<double>& alternatives) {
    const std::size_t m = alternatives.size();
    std::vector<double> criteria;
    for (std::size_t j = 0; j + 1 < m; ++j) {
        if (!std::isfinite(alternatives[j]) || !(alternatives[j] < alternatives[j + 1])) {
            break;
        }
        criteria.push_back(0.5 * (alternatives[j] + alternatives[j + 1]));
    }
    refuse_if(m < 2 || criteria.size() + 1 != m || !std::isfinite(alternatives.back()),
              "the alternatives are no list of at least two increasing finite numbers: give one");
    return criteria;
}

void check(const Axis& axis) {
    refuse_if(axis.values.empty(), "{} has no values: give at least one", axis.name);
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
        const double value = axis.values[i];
        refuse_if(
            !std::isfinite(value) || (i > 0 && value <= axis.values[i - 1]),
            "{} has the value {} at place {}: give finite numbers, each above the one before it",
            axis.name, value, i + 1);
    }
}

/// How far the chances of all outcomes may add up beside 1.
constexpr double kSumSlack = 1e-9;

void check_names(std::string_view what, const Grid& grid, std::span<const std::string> names) {
    bool same = grid.dimensions() == names.size();
    for (std::size_t k = 0; same && k < names.size(); ++k) {
        same = grid.axis(k).name == names[k];
    }
    refuse_if(!same, "the {} have other axes than the model: give {}", what,
              fmt::join(names, ", "));
}

[[noreturn]] void no_chances(const std::vector<double>& stimulus,
                             const std::vector<double>& parameters) {
    throw std::invalid_argument(
        fmt::format("the model gives no chances that add up to 1 at stimulus {} and parameters {}: "
                    "give parameters in their ranges",
                    fmt::join(stimulus, ", "), fmt::join(parameters, ", ")));
}

}  // namespace

double slope_of(SlopeAs as, double value) {
    switch (as) {
        case SlopeAs::slope:
            return value;
        case SlopeAs::log10_slope:
            return power_of_ten(value);
        case SlopeAs::sd:
            return 1.0 / value;
    }
    return value;
}

OutcomeModel psychometric_model(Family family, LapseForm form, SlopeAs slope_as) {
    OutcomeModel model = two_outcomes(family, form, slope_as, false);
    model.shape = OutcomeModel::Shape{family, form, slope_as};
    return model;
}

OutcomeModel covariate_model(Family family, LapseForm form, SlopeAs slope_as) {
    return two_outcomes(family, form, slope_as, true);
}

OutcomeModel identification_model(const std::vector<double>& alternatives) {
    std::vector<double> criteria = criteria_between(alternatives);
    OutcomeModel model;
    model.stimulus = {"stimulus"};
    model.parameters = {"noise", "bias", "lapse"};
    model.outcomes = criteria.size() + 1;
    model.same = fmt::format("{}", fmt::join(alternatives, " "));
    model.chances = [criteria = std::move(criteria)](std::span<const double> x,
                                                     std::span<const double> s,
                                                     std::span<double> chances) {
        const double noise = s[0];
        const double lapse = s[2];
        refuse_if(!(noise > 0.0) || !(lapse >= 0.0 && lapse <= 1.0),
                  "noise is {} and lapse {}: give a noise above 0 and a lapse from 0 to 1", noise,
                  lapse);
        const double guess = lapse / static_cast<double>(chances.size());
        Sides left;
        for (std::size_t j = 0; j < chances.size(); ++j) {
            const Sides right = j < criteria.size() ? sides_of((criteria[j] - x[0] - s[1]) / noise)
                                                    : Sides{1.0, 0.0};
            chances[j] = guess + (1.0 - lapse) * between(left, right);
            left = right;
        }
    };
    return model;
}

Grid::Grid(std::vector<Axis> axes) : axes_(std::move(axes)), strides_(axes_.size()), size_(1) {
    refuse_if(axes_.empty(), "the grid has no axis: give at least one");
    for (std::size_t k = axes_.size(); k-- > 0;) {
        check(axes_[k]);
        const auto same = std::ranges::count_if(
            axes_, [this, k](const Axis& other) { return other.name == axes_[k].name; });
        refuse_if(same > 1, "two axes are called {}: give each its own name", axes_[k].name);
        strides_[k] = size_;
        refuse_if(axes_[k].values.size() > kMaxCells / size_,
                  "the grid has more than {} cells: give fewer values, above all to {}", kMaxCells,
                  axes_[k].name);
        size_ *= axes_[k].values.size();
    }
}

std::vector<double> Grid::point(std::size_t cell) const {
    std::vector<double> point(axes_.size());
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        point[k] = axes_[k].values[index(cell, k)];
    }
    return point;
}

std::size_t Grid::cell_at(std::span<const double> point) const {
    refuse_if(point.size() != axes_.size(), "the stimulus has {} coordinates: give {}",
              point.size(), axes_.size());
    std::size_t cell = 0;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        const std::vector<double>& values = axes_[k].values;
        const double slack = 1e-9 * std::max({values.back() - values.front(),
                                              std::fabs(values.front()), std::fabs(values.back())});
        const auto near = std::ranges::lower_bound(values, point[k] - slack);
        refuse_if(near == values.end() || !(std::fabs(*near - point[k]) <= slack),
                  "{} is {}, which is none of its {} values from {} to {}: give one of them, or "
                  "add it to the configuration",
                  axes_[k].name, point[k], values.size(), values.front(), values.back());
        cell += strides_[k] * static_cast<std::size_t>(near - values.begin());
    }
    return cell;
}

std::vector<double> evenly(double from, double to, std::size_t count) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double part =
            static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(count - 1, 1));
        values[i] = from + (to - from) * part;
    }
    if (count > 1) {
        values.back() = to;
    }
    return values;
}

double twelve_digits(double x, double size) {
    constexpr double kDigitsPerBit = 0.30103;
    const int before = static_cast<int>(std::floor(kDigitsPerBit * std::ilogb(size)));
    const std::string text = fmt::format("{:.{}f}", x, std::clamp(11 - before, 0, 300));
    return parsed<double>(text).value_or(x) + 0.0;  // no -0
}

LikelihoodTable::LikelihoodTable(const OutcomeModel& model, Grid stimuli, Grid parameters)
    : stimuli_(std::move(stimuli)), parameters_(std::move(parameters)), outcomes_(model.outcomes) {
    check_names("stimuli", stimuli_, model.stimulus);
    check_names("parameters", parameters_, model.parameters);
    const std::size_t max = kMaxBytes / sizeof(double) / (outcomes_ + 1);
    refuse_if(stimuli_.size() > max / parameters_.size(),
              "{} stimuli, {} parameter cells and {} outcomes need {:.0f} MB of tables, more than "
              "{} MB: give fewer values to the longest axis",
              stimuli_.size(), parameters_.size(), outcomes_,
              megabytes(model, stimuli_, parameters_), kMaxBytes / 1'000'000);
    values_.resize(stimuli_.size() * parameters_.size() * (outcomes_ + 1));
    fill(model);
}

double LikelihoodTable::megabytes(const OutcomeModel& model,
                                  const Grid& stimuli,
                                  const Grid& parameters) noexcept {
    return 1e-6 * static_cast<double>(sizeof(double) * (model.outcomes + 1)) *
           static_cast<double>(stimuli.size()) * static_cast<double>(parameters.size());
}

void LikelihoodTable::fill(const OutcomeModel& model) {
    std::vector<std::vector<double>> points(stimuli_.size());
    for (std::size_t x = 0; x < points.size(); ++x) {
        points[x] = stimuli_.point(x);
    }
    const std::size_t cells = parameters_.size();
    std::vector<double> chances(outcomes_);
    for (std::size_t cell = 0; cell < cells; ++cell) {
        const std::vector<double> s = parameters_.point(cell);
        for (std::size_t x = 0; x < points.size(); ++x) {
            model.chances(points[x], s, chances);
            double* column = &values_[x * (outcomes_ + 1) * cells + cell];
            double sum = 0.0;
            double entropy = 0.0;
            for (std::size_t r = 0; r < outcomes_; ++r) {
                column[r * cells] = chances[r];
                sum += chances[r];
                entropy -= p_log_p(chances[r]);
                if (!(chances[r] >= 0.0)) {
                    sum = -1.0;
                    break;
                }
            }
            if (!(std::fabs(sum - 1.0) <= kSumSlack)) {
                no_chances(points[x], s);
            }
            column[outcomes_ * cells] = entropy;
        }
    }
}

}  // namespace palpate::protocols
