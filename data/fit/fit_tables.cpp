
#include <fmt/format.h>

#include "data/fit/fit_words.hpp"

namespace palpate::data {
namespace {

std::string key_of(Quantity quantity) {
    switch (quantity) {
        case Quantity::threshold:
            return "threshold";
        case Quantity::jnd:
            return "jnd";
        case Quantity::weber:
            return "weber_fraction";
        case Quantity::slope:
            return "slope";
        case Quantity::guess:
            return "guess";
        case Quantity::lapse:
            return "lapse";
        case Quantity::at_share:
            return "stimulus_at";
    }
    return "";
}

std::string quantity_text(const FitOptions& options, Quantity quantity) {
    return quantity == Quantity::at_share ? fmt::format("x of P = {:g}", options.at.value_or(0.5))
                                          : std::string(word_of(quantity));
}

}  // namespace

Table estimates_table(const FitReport& report, const FittedCurve& curve) {
    const FitOptions& options = report.options;
    Table table{.place = "*",
                .columns = heads({"quantity| ", "estimate|estimate|s", "given||-", "|  ", "se|se|s",
                                  "profile_95|profile|so", "bootstrap_95|bootstrap|so",
                                  "corrected|corrected|s"})};
    for (const FitEstimate& one : curve.estimates) {
        const bool as_lapse = options.spec.two_sided && one.quantity == Quantity::guess;
        table.rows.push_back({Named{key_of(one.quantity), quantity_text(options, one.quantity)},
                              one.why.empty() ? cell_of(one.value) : Cell(Nothing{one.why}),
                              one.fixed,
                              std::string(!one.fixed ? ""
                                          : as_lapse ? "as lapse"
                                                     : "given"),
                              cell_of(one.se), cell_of(one.profile), cell_of(one.bootstrap),
                              cell_of(one.corrected)});
    }
    return table;
}

Table differences_table(const FitReport& report) {
    Table table{.place = "differences/-",
                .title =
                    "  Within person (interval: bootstrap; p: likelihood ratio, chi-square of "
                    "1 df; of JND: of equal slopes b)",
                .columns = heads({"participant|person", "comparison", "quantity",
                                  "difference|difference|s", "bootstrap_95|interval|so", "p|p|p"}),
                .index = 3};
    for (const Difference& one : report.differences) {
        const std::string comparison =
            fmt::format("{} - {}", one.condition, report.conditions.front());
        table.rows.push_back(
            {one.participant, comparison, Named{"threshold", "threshold"},
             cell_of(one.threshold, one.determined ? "unbounded: that of a condition is"
                                                   : "not determined: that of a condition is not"),
             cell_of(one.threshold_interval), cell_of(one.threshold_p)});
        table.rows.push_back({one.participant, comparison, Named{"jnd", "JND"},
                              cell_of(one.jnd, "unbounded: that of a condition is"),
                              cell_of(one.jnd_interval), cell_of(one.slope_p)});
    }
    return table;
}

}  // namespace palpate::data
