#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/choice/identification.hpp"
#include "data/export/json_text.hpp"

namespace palpate::data {
namespace {

std::string ends_text(const Interval& interval) {
    return fmt::format("[{:.3g}, {:.3g}]", interval.low, interval.high);
}

std::string with(double value, const std::optional<Interval>& interval) {
    return fmt::format("{:.3g}", value) + (interval ? " " + ends_text(*interval) : "");
}

Json finite(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json finite(const std::optional<double>& value) {
    return value ? finite(*value) : Json(nullptr);
}

Json interval_json(const std::optional<Interval>& interval) {
    return interval ? Json::array({finite(interval->low), finite(interval->high)}) : Json(nullptr);
}

/// Which ends are null since the answers do not bound them.
Json open_json(const std::optional<Interval>& interval) {
    const bool low = interval && std::isinf(interval->low);
    const bool high = interval && std::isinf(interval->high);
    return low && high ? Json("both") : low ? Json("low") : high ? Json("high") : Json(nullptr);
}

/// "concave and flat (up to 0.21)": pairs that were never confused.
std::string never_confused(const IdentificationReport& report,
                           const IdentifiedPerson& person,
                           std::size_t f) {
    std::string text;
    for (std::size_t i = 0; i < report.names.size(); ++i) {
        for (std::size_t j = i + 1; j < report.names.size(); ++j) {
            if (person.counts[f][i][j] + person.counts[f][j][i] == 0) {
                text += fmt::format("{}{} and {} (0 to {:.2g})", text.empty() ? "" : ", ",
                                    report.names[i], report.names[j],
                                    person.similarity[f]->intervals[i][j].high);
            }
        }
    }
    return text;
}

void person_text(const IdentificationReport& report,
                 const IdentifiedPerson& person,
                 std::string& out) {
    const auto& frictions = report.table.frictions;
    out += fmt::format("\n{}\n", person.name);
    for (std::size_t f = 0; f < frictions.size(); ++f) {
        const ThurstonePart& part = person.thurstone.parts[f];
        out += fmt::format("  {:<12} sigma {}\n", frictions[f],
                           part.end == SigmaEnd::both
                               ? with(part.sigma, part.sigma_interval)
                               : why_unbounded(part.end) + " " + ends_text(*part.sigma_interval));
        if (f > 0 && part.end != SigmaEnd::unknown) {
            const ThurstoneChange& change = person.changes[f - 1];
            const auto number = [](const std::optional<double>& value, const Interval& interval) {
                return (value ? fmt::format("{:.3g}", *value) : "no end") + " " +
                       ends_text(interval);
            };
            out += fmt::format("  {:<12} sigma / that of {}: {}, p {:.3g}; shift: {}, p {:.3g}\n",
                               "", frictions.front(), number(change.ratio, change.ratio_interval),
                               change.ratio_p, number(change.shift, change.shift_interval),
                               change.shift_p);
        }
        if (const auto& fit = person.similarity[f]; fit) {
            out += fmt::format("  {:<12} mean similarity {:.3g}; bias", "", mean_similarity(*fit));
            for (std::size_t j = 0; j < report.names.size(); ++j) {
                out += fmt::format("{} {} {:.2f}", j > 0 ? "," : "", report.names[j], fit->bias[j]);
            }
            out += '\n';
            if (const std::string never = never_confused(report, person, f); !never.empty()) {
                out += fmt::format("  {:<12} at the boundary, never confused: {}\n", "", never);
            }
            for (const auto& [i, j] : fit->one_way) {
                out += fmt::format(
                    "  {:<12} at the boundary: {} and {} were confused one way alone: similarity "
                    "0 (to {:.2g}), and the biases on either side have no ratio\n",
                    "", report.names[i], report.names[j], fit->intervals[i][j].high);
            }
        } else {
            out += fmt::format("  {:<12} no similarities: {}\n", "", person.no_similarity[f]);
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

std::string identification_text(const IdentificationReport& report) {
    std::string out = fmt::format("{}: {}, {}\n", report.table.source,
                                  counted(report.people.size(), "person", "people"),
                                  counted(report.names.size(), "item"));
    out += report.table.left_out ? left_out_text(*report.table.left_out) : std::string();
    out += "Items:";
    for (std::size_t i = 0; i < report.names.size(); ++i) {
        out += fmt::format("{} {} ({:g})", i > 0 ? "," : "", report.names[i], report.values[i]);
    }
    out += fmt::format(
        "\nThurstone: sigma in the unit of the items, one a friction; criteria the same in all; "
        "lapses {:g}.\n"
        "Similarity choice: 0 never confused, 1 alike; biases of the answers sum to 1.\n"
        "Intervals: 95 %, by profile likelihood; inf: no end that the answers bound. Changes are "
        "against {}.\n",
        report.options.lapse, report.table.frictions.front());
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
        out += fmt::format("  {:<36} {:>10}  {}{}{}\n", one.what,
                           counted(one.mean.people, "person", "people"),
                           one.mean.people > 0 ? with(shown(one.mean.mean), interval) : "-",
                           one.ratio && one.mean.people > 0 ? " (geometric mean)" : "",
                           one.test ? fmt::format(", sign-flip p {:.3g}", one.test->p) : "");
        if (!one.left_out.empty()) {
            out += fmt::format("  {:<36} {}\n", "", without_text(one.left_out));
            out += one.median ? fmt::format("  {:<36} {:>10}  {:.3g}, what is unbounded by rank\n",
                                            "", "median", shown(*one.median))
                              : "";
        }
    }
    for (const std::string& who : report.left_out) {
        out += fmt::format("\nLeft out: {}\n", who);
    }
    const std::string versions = versions_text(report.table.versions);
    return versions.empty() ? out : out + '\n' + versions;
}

std::string identification_json(const IdentificationReport& report) {
    Json all = {{"source", report.table.source},
                {"items", report.names},
                {"values", report.values},
                {"lapse", report.options.lapse},
                {"frictions", report.table.frictions},
                {"versions", versions_json(report.table.versions)},
                {"left_out",
                 report.table.left_out ? left_out_json(*report.table.left_out) : Json(nullptr)}};
    for (const IdentifiedPerson& person : report.people) {
        Json one = {{"participant", person.name},
                    {"log_likelihood", person.thurstone.log_likelihood},
                    {"log_likelihood_nelder_mead", finite(person.thurstone.second)},
                    {"optimisers_agree", person.thurstone.agree},
                    {"deviance", person.thurstone.deviance},
                    {"df", person.thurstone.df}};
        const bool scale =
            std::ranges::any_of(person.thurstone.parts, [](const ThurstonePart& part) {
                return part.end == SigmaEnd::both || part.end == SigmaEnd::sharp;
            });
        for (const double criterion : person.thurstone.criteria) {
            one["criteria"].push_back(scale ? finite(criterion) : Json(nullptr));
        }
        for (std::size_t f = 0; f < report.table.frictions.size(); ++f) {
            const ThurstonePart& part = person.thurstone.parts[f];
            const bool known = part.end == SigmaEnd::both;
            Json friction = {{"friction", report.table.frictions[f]},
                             {"counts", person.counts[f]},
                             {"sigma", known ? Json(part.sigma) : Json(nullptr)},
                             {"sigma_why", known ? Json(nullptr) : Json(why_unbounded(part.end))},
                             {"sigma_95", interval_json(part.sigma_interval)},
                             {"sigma_open", open_json(part.sigma_interval)}};
            if (f > 0) {
                const ThurstoneChange& change = person.changes[f - 1];
                friction["ratio"] = finite(change.ratio);
                friction["ratio_95"] = interval_json(change.ratio_interval);
                friction["ratio_open"] = open_json(change.ratio_interval);
                friction["ratio_p"] = change.ratio_p;
                friction["shift"] = finite(change.shift);
                friction["shift_95"] = interval_json(change.shift_interval);
                friction["shift_open"] = open_json(change.shift_interval);
                friction["shift_p"] = change.shift_p;
            }
            friction["similarity_why"] =
                person.no_similarity[f].empty() ? Json(nullptr) : Json(person.no_similarity[f]);
            if (const auto& fit = person.similarity[f]; fit) {
                friction["bias"] = fit->bias;
                friction["similarity"] = fit->similarity;
                friction["similarity_95"] = Json::array();
                for (const auto& row : fit->intervals) {
                    Json ends = Json::array();
                    for (const Interval& both : row) {
                        ends.push_back(interval_json(both));
                    }
                    friction["similarity_95"].push_back(ends);
                }
                friction["similarity_one_way"] = Json::array();
                for (const auto& [i, j] : fit->one_way) {
                    friction["similarity_one_way"].push_back({report.names[i], report.names[j]});
                }
                friction["mean_similarity"] = mean_similarity(*fit);
                friction["similarity_deviance"] = fit->deviance;
            }
            one["conditions"].push_back(friction);
        }
        all["people"].push_back(one);
    }
    for (const IdentifiedNumber& one : report.over_people) {
        Json left_out = Json::array();
        for (const LeftOutPerson& person : one.left_out) {
            left_out.push_back({{"participant", person.name}, {"why", person.why}});
        }
        all["over_people"].push_back(
            {{"what", one.what},
             {"people", one.mean.people},
             {"left_out", left_out},
             {"logarithm", one.ratio},
             {"mean", finite(one.mean.mean)},
             {"median", finite(one.median)},
             {"interval_95", interval_json(one.mean.interval)},
             {"sign_flip_p", one.test ? Json(one.test->p) : Json(nullptr)}});
    }
    all["not_fitted"] = report.left_out;
    return json_text(all);
}

}  // namespace palpate::data
