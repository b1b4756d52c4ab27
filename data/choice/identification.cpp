#include "data/choice/identification.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/export/json_text.hpp"
#include "data/inference/mixed_logit.hpp"

namespace palpate::data {
namespace {

std::optional<double> value_of(const IdentificationOptions& options, const std::string& name) {
    if (const auto found = options.items.find(name); found != options.items.end()) {
        return found->second;
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), value);
    const bool number =
        error == std::errc{} && end == name.data() + name.size() && std::isfinite(value);
    return number ? std::optional(value) : std::nullopt;
}

/// Items and responses are one list, by value.
void name_items(IdentificationReport& report) {
    std::vector<std::pair<double, std::string>> all;
    std::vector<std::string> names = report.table.shapes;
    names.insert(names.end(), report.table.responses.begin(), report.table.responses.end());
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    for (const std::string& name : report.options.given) {
        if (!std::ranges::binary_search(names, name)) {
            throw std::invalid_argument(
                fmt::format("{}: there is no item \"{}\"{}: its items are {}", report.table.source,
                            name, suggestion(name, names, ""), fmt::join(names, ", ")));
        }
    }
    for (const std::string& name : names) {
        const std::optional<double> value = value_of(report.options, name);
        if (!value) {
            throw std::invalid_argument(
                fmt::format("{}: \"{}\" has no value to be ordered by: give --item \"{}=VALUE\", "
                            "and so for every item (of a database: the curvature of its object)",
                            report.table.source, name, name));
        }
        all.emplace_back(*value, name);
    }
    std::ranges::sort(all);
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

/// Against a model with less: p of chi-square with the parameters that are missing.
double p_against(const ThurstoneFit& full, const ThurstoneFit& less) {
    return chi_square_p(std::max(2.0 * (full.log_likelihood - less.log_likelihood), 0.0), 1);
}

IdentifiedPerson fitted(const IdentificationReport& report, std::size_t subject) {
    const ThurstoneSpec spec{.items = report.values, .lapse = report.options.lapse};
    IdentifiedPerson person{.name = report.table.subjects[subject],
                            .counts = counts_of(report, subject)};
    person.thurstone = fit_thurstone(person.counts, spec);
    for (std::size_t f = 1; f < person.counts.size(); ++f) {
        const std::vector<CallCounts> pair{person.counts.front(), person.counts[f]};
        ThurstoneSpec plain = spec;
        plain.checked = false;
        const ThurstoneFit full = fit_thurstone(pair, plain);
        ThurstoneSpec one = plain;
        one.one_sigma = true;
        ThurstoneSpec still = plain;
        still.no_shift = true;
        const auto& parts = person.thurstone.parts;
        person.changes.push_back({.ratio = parts[f].sigma / parts.front().sigma,
                                  .ratio_p = p_against(full, fit_thurstone(pair, one)),
                                  .shift = parts[f].shift,
                                  .shift_p = p_against(full, fit_thurstone(pair, still))});
    }
    for (const CallCounts& one : person.counts) {
        try {
            person.similarity.emplace_back(fit_similarity(one));
        } catch (const std::invalid_argument&) {
            person.similarity.emplace_back();
        }
    }
    return person;
}

void add_number(IdentificationReport& report,
                std::string what,
                std::vector<double> values,
                bool ratio,
                bool test) {
    if (values.size() < 2) {
        return;
    }
    report.over_people.push_back({.what = std::move(what),
                                  .mean = mean_over_people(values),
                                  .ratio = ratio,
                                  .test = test ? std::optional(sign_flip(values)) : std::nullopt});
}

/// The answers tell both sigmas, this condition's and the first one's.
bool comparable(const IdentifiedPerson& person, std::size_t condition) {
    const auto& parts = person.thurstone.parts;
    return parts.front().sigma_interval && parts[condition].sigma_interval;
}

void over_people(IdentificationReport& report) {
    const auto& frictions = report.table.frictions;
    const auto collect = [&](const auto& number) {
        std::vector<double> values;
        for (const IdentifiedPerson& person : report.people) {
            if (const std::optional<double> value = number(person); value) {
                values.push_back(*value);
            }
        }
        return values;
    };
    const auto similarity = [](const IdentifiedPerson& person, std::size_t f) {
        const auto& fit = person.similarity[f];
        return fit ? std::optional(mean_similarity(*fit)) : std::nullopt;
    };
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        add_number(report, "sigma, " + frictions[f], collect([f](const IdentifiedPerson& person) {
                       const ThurstonePart& part = person.thurstone.parts[f];
                       return part.sigma_interval ? std::optional(std::log(part.sigma))
                                                  : std::nullopt;
                   }),
                   true, false);
        add_number(report, "mean similarity, " + frictions[f],
                   collect([&](const IdentifiedPerson& person) { return similarity(person, f); }),
                   false, false);
    }
    for (std::size_t f = 1; f < frictions.size(); ++f) {
        const std::string against = frictions[f] + " against " + frictions.front();
        add_number(report, "sigma, " + against, collect([f](const IdentifiedPerson& person) {
                       const auto& parts = person.thurstone.parts;
                       return comparable(person, f)
                                ? std::optional(std::log(parts[f].sigma / parts.front().sigma))
                                : std::nullopt;
                   }),
                   true, true);
        add_number(report, "shift, " + against, collect([f](const IdentifiedPerson& person) {
                       return comparable(person, f) ? std::optional(person.thurstone.parts[f].shift)
                                                    : std::nullopt;
                   }),
                   false, true);
        add_number(report, "mean similarity, " + against,
                   collect([&](const IdentifiedPerson& person) -> std::optional<double> {
                       const auto one = similarity(person, 0);
                       const auto two = similarity(person, f);
                       return one && two ? std::optional(*two - *one) : std::nullopt;
                   }),
                   false, true);
    }
}

std::string with(double value, const std::optional<Interval>& interval) {
    return interval ? fmt::format("{:.3g} [{:.3g}, {:.3g}]", value, interval->low, interval->high)
                    : fmt::format("{:.3g}", value);
}

Json interval_json(const std::optional<Interval>& interval) {
    return interval ? Json::array({interval->low, interval->high}) : Json(nullptr);
}

Json finite(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

void person_text(const IdentificationReport& report,
                 const IdentifiedPerson& person,
                 std::string& out) {
    const auto& frictions = report.table.frictions;
    out += fmt::format("\n{}\n", person.name);
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        const ThurstonePart& part = person.thurstone.parts[f];
        out += fmt::format("  {:<12} sigma {}", frictions[f],
                           part.unbounded ? "not bounded: no answer is wrong but by lapse"
                           : part.sigma_interval
                               ? with(part.sigma, part.sigma_interval)
                               : "not told: too few different answers, or none wrong elsewhere");
        if (f > 0 && comparable(person, f)) {
            const ThurstoneChange& change = person.changes[f - 1];
            out +=
                fmt::format("; {:.3g} of the first, p {:.3g}; shift {}, p {:.3g}", change.ratio,
                            change.ratio_p, with(part.shift, part.shift_interval), change.shift_p);
        }
        out += '\n';
        if (const auto& fit = person.similarity[f]; fit) {
            out += fmt::format("  {:<12} mean similarity {:.3g}; bias", "", mean_similarity(*fit));
            for (std::size_t j = 0; j < report.names.size(); ++j) {
                out += fmt::format("{} {} {:.2f}", j > 0 ? "," : "", report.names[j], fit->bias[j]);
            }
            out += '\n';
        } else {
            out +=
                fmt::format("  {:<12} no similarities: an item was never called by its name\n", "");
        }
    }
    out += fmt::format("  {:<12} deviance {:.1f} of {} df\n", "", person.thurstone.deviance,
                       person.thurstone.df);
    if (!person.thurstone.agree) {
        out += fmt::format(
            "  {:<12} the second optimiser ends elsewhere: log-likelihood {:.6f}, not {:.6f}\n", "",
            person.thurstone.second, person.thurstone.log_likelihood);
    }
}

}  // namespace

std::map<std::string, double> item_values(Database& database, const std::string& study) {
    std::map<std::string, double> values;
    Statement row = database.prepare(
        "SELECT DISTINCT planned_object, curvature_per_m FROM plan JOIN session USING (session_id) "
        "JOIN study USING (study_id) WHERE study_name = ?1 AND curvature_per_m IS NOT NULL");
    row.bind(1, study);
    while (row.step()) {
        values[row.text(0)] = row.real(1);
    }
    return values;
}

IdentificationReport identification_of(TrialTable table, const IdentificationOptions& options) {
    IdentificationReport report{.table = std::move(table), .options = options};
    if (report.table.alternatives == 0) {
        throw std::invalid_argument(fmt::format(
            "{}: the answers are yes and no: these models are of identifications; palpate stats "
            "gives d' and c",
            report.table.source));
    }
    name_items(report);
    for (std::size_t subject = 0; subject < report.table.subjects.size(); ++subject) {
        try {
            report.people.push_back(fitted(report, subject));
        } catch (const std::invalid_argument& e) {
            report.left_out.push_back(report.table.subjects[subject] + ": " + e.what());
        }
    }
    if (report.people.empty()) {
        throw std::invalid_argument(
            fmt::format("{}: {}", report.table.source,
                        report.left_out.empty() ? "nobody answered" : report.left_out.front()));
    }
    over_people(report);
    return report;
}

std::string identification_text(const IdentificationReport& report) {
    std::string out = fmt::format("{}: {} people, {} items\n", report.table.source,
                                  report.people.size(), report.names.size());
    out += "Items:";
    for (std::size_t i = 0; i < report.names.size(); ++i) {
        out += fmt::format("{} {} ({:g})", i > 0 ? "," : "", report.names[i], report.values[i]);
    }
    out += fmt::format(
        "\nThurstone: sigma in the unit of the items, one a friction; criteria the same in all; "
        "lapses {:g}.\n"
        "Similarity choice: 0 never confused, 1 alike; biases of the answers sum to 1. Intervals: "
        "95 %.\n",
        report.options.lapse);
    for (const IdentifiedPerson& person : report.people) {
        person_text(report, person, out);
    }
    if (!report.over_people.empty()) {
        out += "\nOver people\n";
    }
    for (const IdentifiedNumber& one : report.over_people) {
        const auto shown = [&](double value) {
            return one.ratio ? std::exp(value) : value;
        };
        std::optional<Interval> interval;
        if (one.mean.interval) {
            interval = Interval{shown(one.mean.interval->low), shown(one.mean.interval->high)};
        }
        out +=
            fmt::format("  {:<36} {:>3} people  {}{}{}\n", one.what, one.mean.people,
                        with(shown(one.mean.mean), interval), one.ratio ? " (geometric mean)" : "",
                        one.test ? fmt::format(", sign-flip p {:.3g}", one.test->p) : "");
    }
    for (const std::string& who : report.left_out) {
        out += fmt::format("\nLeft out: {}\n", who);
    }
    return out;
}

std::string identification_json(const IdentificationReport& report) {
    Json all = {{"source", report.table.source},
                {"items", report.names},
                {"values", report.values},
                {"lapse", report.options.lapse},
                {"frictions", report.table.frictions}};
    for (const IdentifiedPerson& person : report.people) {
        Json one = {{"participant", person.name},
                    {"log_likelihood", person.thurstone.log_likelihood},
                    {"log_likelihood_nelder_mead", finite(person.thurstone.second)},
                    {"optimisers_agree", person.thurstone.agree},
                    {"deviance", person.thurstone.deviance},
                    {"df", person.thurstone.df}};
        for (const double criterion : person.thurstone.criteria) {
            one["criteria"].push_back(finite(criterion));
        }
        for (std::size_t f = 0; f < report.table.frictions.size(); ++f) {
            const ThurstonePart& part = person.thurstone.parts[f];
            Json friction = {
                {"friction", report.table.frictions[f]},
                {"counts", person.counts[f]},
                {"sigma", part.sigma_interval ? Json(part.sigma) : Json(nullptr)},
                {"sigma_95", interval_json(part.sigma_interval)},
                {"shift", f == 0 || comparable(person, f) ? Json(part.shift) : Json(nullptr)},
                {"shift_95", interval_json(part.shift_interval)}};
            if (f > 0 && comparable(person, f)) {
                friction["ratio_p"] = person.changes[f - 1].ratio_p;
                friction["shift_p"] = person.changes[f - 1].shift_p;
            }
            if (const auto& fit = person.similarity[f]; fit) {
                friction["bias"] = fit->bias;
                friction["similarity"] = fit->similarity;
                friction["mean_similarity"] = mean_similarity(*fit);
                friction["similarity_deviance"] = fit->deviance;
            }
            one["conditions"].push_back(friction);
        }
        all["people"].push_back(one);
    }
    for (const IdentifiedNumber& one : report.over_people) {
        all["over_people"].push_back(
            {{"what", one.what},
             {"people", one.mean.people},
             {"logarithm", one.ratio},
             {"mean", one.mean.mean},
             {"interval_95", interval_json(one.mean.interval)},
             {"sign_flip_p", one.test ? Json(one.test->p) : Json(nullptr)}});
    }
    all["left_out"] = report.left_out;
    return json_text(all);
}

}  // namespace palpate::data
