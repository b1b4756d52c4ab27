#include <iostream>

#include "protocols/procedure/quest_plus.hpp"
#include "tests/bench/commands.hpp"
#include "tests/bench/report.hpp"

namespace palpate::bench {
namespace {

using namespace palpate::protocols;

struct Case {
    const char* name;
    QuestPlusSpec spec;
};

/// Threshold, slope and lapse: 20,000 cells, 40 stimuli, 2 outcomes.
QuestPlusSpec three_parameters() {
    return {.model = psychometric_model(Family::weibull_log10, LapseForm::upper),
            .stimuli = Grid({{"stimulus", evenly(-2.0, 0.0, 40)}}),
            .parameters = Grid({{"threshold", evenly(-2.0, 0.0, 100)},
                                {"slope", evenly(1.0, 8.0, 20)},
                                {"guess", {0.5}},
                                {"lapse", evenly(0.0, 0.09, 10)}}),
            .trials = 1'000'000};
}

/// Noise, bias and lapse of an identification: 20,000 cells, 40 stimuli, 5 outcomes.
QuestPlusSpec five_outcomes() {
    return {.model = identification_model({-10.0, -5.0, 0.0, 5.0, 10.0}),
            .stimuli = Grid({{"stimulus", evenly(-20.0, 20.0, 40)}}),
            .parameters = Grid({{"noise", evenly(0.5, 10.0, 50)},
                                {"bias", evenly(-5.0, 5.0, 40)},
                                {"lapse", evenly(0.0, 0.09, 10)}}),
            .trials = 1'000'000};
}

QuestPlusSpec marginal() {
    QuestPlusSpec spec = three_parameters();
    spec.nuisance = {"slope", "lapse"};
    return spec;
}

}  // namespace

int procedure_command(Words words) {
    constexpr int kChoices = 200;
    const std::string csv_name = words.value("--csv");
    words.finish();
    Output csv(csv_name,
               "machine,procedure,stimuli,cells,outcomes,table_mb,build_ms,choose_p50_ms,"
               "choose_p99_ms,update_p50_ms\n");
    const std::array<Case, 3> cases{Case{"quest_plus", three_parameters()},
                                    Case{"quest_plus marginal", marginal()},
                                    Case{"quest_plus identification", five_outcomes()}};
    std::cout << machine() << '\n';
    std::printf("%-26s %8s %7s %9s %9s %9s %11s %11s %11s\n", "procedure", "stimuli", "cells",
                "outcomes", "table MB", "build ms", "choose p50", "choose p99", "update p50");
    for (const Case& one : cases) {
        const auto start = std::chrono::steady_clock::now();
        QuestPlus quest(one.spec);
        const double build = 1e3 * seconds_since(start);
        std::vector<double> choosing;
        std::vector<double> updating;
        for (std::size_t i = 0; i < kChoices; ++i) {
            const auto before = std::chrono::steady_clock::now();
            const std::vector<double> x = quest.next();
            choosing.push_back(1e3 * seconds_since(before));
            const auto between = std::chrono::steady_clock::now();
            quest.update(x, i * i % 3 == 1 ? 1 : 0);
            updating.push_back(1e3 * seconds_since(between));
        }
        const std::size_t stimuli = one.spec.stimuli.size();
        const std::size_t cells = one.spec.parameters.size();
        const std::size_t outcomes = one.spec.model.outcomes;
        const double megabytes = 8e-6 * static_cast<double>(stimuli * cells * (outcomes + 1));
        const double p50 = percentile(choosing, 0.5);
        const double p99 = percentile(choosing, 0.99);
        const double update = percentile(updating, 0.5);
        std::printf("%-26s %8zu %7zu %9zu %9.1f %9.1f %11.3f %11.3f %11.3f\n", one.name, stimuli,
                    cells, outcomes, megabytes, build, p50, p99, update);
        csv << printed("\"%s\",\"%s\",%zu,%zu,%zu,%.1f,%.1f,%.4f,%.4f,%.4f\n", machine().c_str(),
                       one.name, stimuli, cells, outcomes, megabytes, build, p50, p99, update);
    }
    csv.finish();
    return 0;
}

}  // namespace palpate::bench
