#include "data/choice/identification.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/statistics/distributions.hpp"

namespace palpate::data {
namespace {

std::optional<double> value_of(const IdentificationOptions& options, const std::string& name) {
    if (const auto found = options.items.find(name); found != options.items.end()) {
        return found->second;
    }
    const auto value = parsed<double>(name);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Items and responses are one list, by value.
void name_items(IdentificationReport& report) {
    std::vector<std::pair<double, std::string>> all;
    std::vector<std::string> names = report.table.shapes;
    names.insert(names.end(), report.table.responses.begin(), report.table.responses.end());
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    for (const std::string& name : report.options.given) {
        refuse_if(!std::ranges::binary_search(names, name),
                  "{}: there is no item \"{}\"{}: its items are {}", report.table.source, name,
                  suggestion(name, names, ""), fmt::join(names, ", "));
    }
    for (const std::string& name : names) {
        const std::optional<double> value = value_of(report.options, name);
        refuse_if(
            !value,
            "{}: \"{}\" has no value to be ordered by: give --item \"{}=VALUE\", and so for "
            "every item (of a database: the curvature of its object, the same in all versions)",
            report.table.source, name, name);
        all.emplace_back(*value, name);
    }
    std::ranges::sort(all);
    const auto equal = std::ranges::adjacent_find(all, {}, &std::pair<double, std::string>::first);
    if (equal != all.end()) {
        throw std::invalid_argument(fmt::format(
            "{}: \"{}\" and \"{}\" both have the value {}: give each its own, as --item "
            "\"{}=VALUE\"",
            report.table.source, equal->second, (equal + 1)->second, equal->first, equal->second));
    }
    for (const auto& [value, name] : all) {
        report.values.push_back(value);
        report.names.push_back(name);
    }
}

std::size_t place_of(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

std::vector<CallCounts> counts_of(const IdentificationReport& report, std::size_t subject) {
    const TrialTable& table = report.table;
    const std::size_t m = report.names.size();
    std::vector<CallCounts> counts(table.frictions.size(),
                                   CallCounts(m, std::vector<std::int64_t>(m, 0)));
    for (const Trial& trial : table.trials) {
        if (trial.subject == subject && trial.excluded.empty()) {
            const std::size_t item = place_of(report.names, table.shapes[trial.shape]);
            const std::size_t called = place_of(report.names, table.responses[trial.response]);
            ++counts[trial.friction][item][called];
        }
    }
    return counts;
}

/// Against a model with one parameter less, whose fit may end on a lower hill than the profile.
double p_against(const ThurstoneFit& full, const ThurstoneFit& less, double profile_loss) {
    const double loss = std::min(full.log_likelihood - less.log_likelihood, profile_loss);
    return chi_square_p(std::max(2.0 * loss, 0.0), 1);
}

/// @param full  of all conditions, sigmas relative
/// @param own   that condition's part where they are not
ThurstoneChange change_of(const std::vector<CallCounts>& counts,
                          const ThurstoneSpec& spec,
                          const ThurstoneFit& full,
                          std::size_t condition,
                          const ThurstonePart& own) {
    ThurstoneSpec less = spec;
    less.checked = less.intervals = false;
    less.one_sigma = condition;
    ThurstoneSpec still = less;
    still.one_sigma = 0;
    still.no_shift = condition;
    const ThurstonePart& part = full.parts[condition];
    Interval ratio = *part.sigma_interval;
    if (full.parts[0].sigma_interval->low == 0.0) {  // a first sigma of 0 is not refuted
        ratio.high = std::numeric_limits<double>::infinity();
    }
    if (own.sigma_interval->low == 0.0) {
        ratio.low = 0.0;
    }
    const bool known = full.parts[0].end == SigmaEnd::both && part.end == SigmaEnd::both &&
                       own.end == SigmaEnd::both;
    return {.ratio = known ? std::optional(part.sigma / full.parts[0].sigma) : std::nullopt,
            .ratio_interval = ratio,
            .ratio_p = p_against(full, fit_thurstone(counts, less), part.ratio_loss),
            .shift = known && std::isfinite(part.shift_interval->low) &&
                             std::isfinite(part.shift_interval->high)
                       ? std::optional(part.shift)
                       : std::nullopt,
            .shift_interval = *part.shift_interval,
            .shift_p = p_against(full, fit_thurstone(counts, still), part.shift_loss)};
}

IdentifiedPerson fitted(const IdentificationReport& report, std::size_t subject) {
    const ThurstoneSpec spec{.items = report.values, .lapse = report.options.lapse};
    IdentifiedPerson person{.name = report.table.subjects[subject],
                            .counts = counts_of(report, subject)};
    person.thurstone = fit_thurstone(person.counts, spec);
    ThurstoneSpec relative = spec;
    relative.checked = false;
    relative.relative = true;
    const ThurstoneFit full =
        person.counts.size() > 1 ? fit_thurstone(person.counts, relative) : ThurstoneFit{};
    for (std::size_t f = 1; f < person.counts.size(); ++f) {
        person.changes.push_back(
            change_of(person.counts, spec, full, f, person.thurstone.parts[f]));
    }
    for (const CallCounts& one : person.counts) {
        std::size_t named = 0;  // items before the first that was never called by its name
        while (named < one.size() && one[named][named] > 0) {
            ++named;
        }
        const bool all = named == one.size();
        person.similarity.push_back(all ? std::optional(fit_similarity(one)) : std::nullopt);
        person.no_similarity.push_back(
            all ? ""
            : answered(one)
                ? fmt::format("{} was never called by its name: unbounded", report.names[named])
                : "no answers");
    }
    return person;
}

void add_number(IdentificationReport& report,
                std::string what,
                const std::function<Score(const IdentifiedPerson&)>& number,
                bool ratio,
                bool test) {
    if (report.people.size() < 2) {
        return;
    }
    std::vector<Score> all;
    for (const IdentifiedPerson& person : report.people) {
        all.push_back(number(person));
        all.back().name = person.name;
    }
    report.over_people.push_back(over_people(std::move(what), all, test, ratio));
}

/// ln sigma, and on which side it has no end.
Score log_sigma(const ThurstonePart& part) {
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    const double value = std::log(part.sigma);
    return part.end == SigmaEnd::both ? Score{value, value, ""}
                                      : Score{std::nan(""),
                                              part.end == SigmaEnd::sharp   ? -kEndless
                                              : part.end == SigmaEnd::blunt ? kEndless
                                                                            : std::nan(""),
                                              why_unbounded(part.end)};
}

/// Of two numbers the second less the first.
Score difference_of(const Score& first, const Score& second) {
    const double value = second.value - first.value;
    return {value, std::isfinite(value) ? value : std::nan(""),
            first.why.empty() || first.why == second.why ? second.why : first.why};
}

void over_people(IdentificationReport& report) {
    const auto& frictions = report.table.frictions;
    const auto sigma = [](const IdentifiedPerson& person, std::size_t f) {
        return log_sigma(person.thurstone.parts[f]);
    };
    const auto similarity = [](const IdentifiedPerson& person, std::size_t f) {
        const auto& fit = person.similarity[f];
        const double value = fit ? mean_similarity(*fit) : std::nan("");
        return Score{value, value, person.no_similarity[f]};
    };
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        add_number(
            report, "sigma, " + frictions[f],
            [&](const IdentifiedPerson& person) { return sigma(person, f); }, true, false);
        add_number(
            report, "mean similarity, " + frictions[f],
            [&](const IdentifiedPerson& person) { return similarity(person, f); }, false, false);
    }
    for (std::size_t f = 1; f < frictions.size(); ++f) {
        const std::string less = frictions[f] + " - " + frictions.front();
        const auto both = [&](const IdentifiedPerson& person) {
            return difference_of(sigma(person, 0), sigma(person, f));
        };
        add_number(report, "sigma, " + frictions[f] + " / " + frictions.front(), both, true, true);
        add_number(
            report, "shift, " + less,
            [&](const IdentifiedPerson& person) {
                const Score ratio = both(person);
                const double shift = person.changes[f - 1].shift.value_or(std::nan(""));
                return Score{shift, shift, ratio.why.empty() ? "unbounded" : ratio.why};
            },
            false, true);
        add_number(
            report, "mean similarity, " + less,
            [&](const IdentifiedPerson& person) {
                return difference_of(similarity(person, 0), similarity(person, f));
            },
            false, true);
    }
}

}  // namespace

std::string why_unbounded(SigmaEnd end) {
    switch (end) {
        case SigmaEnd::both:
            return {};
        case SigmaEnd::sharp:
            return "as good as 0: the likelihood grows to that end";
        case SigmaEnd::blunt:
            return "unbounded: the answers do not follow the items";
        case SigmaEnd::unknown:
            break;
    }
    return "not known: no answers, or too few different ones";
}

std::map<std::string, double> item_values(Database& database, const std::string& study) {
    std::map<std::string, double> values;
    for (const Statement& row : database.prepare(
             "SELECT planned_object, min(curvature_per_m) FROM plan JOIN session USING "
             "(session_id) JOIN study USING (study_id) WHERE study_name = ?1 AND curvature_per_m "
             "IS NOT NULL GROUP BY 1 HAVING min(curvature_per_m) = max(curvature_per_m)",
             study)) {
        values[row.text(0)] = row.real(1);
    }
    return values;
}

IdentificationReport identification_of(TrialTable table, const IdentificationOptions& options) {
    IdentificationReport report{.table = std::move(table), .options = options};
    refuse_if(report.table.alternatives == 0,
              "{}: the answers are yes and no: these models are of identifications; palpate stats "
              "gives d' and c",
              report.table.source);
    name_items(report);
    for (std::size_t subject = 0; subject < report.table.subjects.size(); ++subject) {
        if (std::ranges::none_of(report.table.trials, [&](const Trial& trial) {
                return trial.subject == subject && trial.excluded.empty();
            })) {
            if (!report.table.left_out) {  // of a database that account says why
                report.left_out.push_back(report.table.subjects[subject] + ": no answer counts");
            }
            continue;
        }
        try {
            report.people.push_back(fitted(report, subject));
        } catch (const std::invalid_argument& e) {
            report.left_out.push_back(report.table.subjects[subject] + ": " + e.what());
        }
    }
    refuse_if(report.people.empty(), "{}: {}{}", report.table.source,
              report.left_out.empty() ? "no answer counts" : report.left_out.front(),
              below(report.table.left_out));
    over_people(report);
    return report;
}

}  // namespace palpate::data
