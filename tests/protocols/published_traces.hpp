#pragma once

#include "tests/support/test_text.hpp"

namespace palpate::tests {

/// A published run of QUEST+ (tests/texts/watson_2017.tsv).
struct PublishedRun {
    std::vector<std::vector<double>> stimuli;  ///< of each trial
    std::string answers;                       ///< '1' is correct
};

inline PublishedRun published_run(const std::string& name) {
    for (const std::vector<std::string>& row : test_rows("watson_2017.tsv")) {
        if (row.at(0) != name) {
            continue;
        }
        PublishedRun run{.stimuli{}, .answers = row.at(1)};
        run.stimuli.resize(run.answers.size());
        for (std::size_t dimension = 2; dimension < row.size(); ++dimension) {
            const std::vector<std::string> values = split(row[dimension], ' ');
            for (std::size_t i = 0; i < run.stimuli.size(); ++i) {
                run.stimuli[i].push_back(std::stod(values.at(i)));
            }
        }
        return run;
    }
    throw std::invalid_argument("no such run: " + name);
}

}  // namespace palpate::tests
