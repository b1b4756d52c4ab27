#pragma once

#include "tests/support/slurp.hpp"

namespace palpate::tests {

/// What a file of tests/texts holds: studies, scripts and tables that tests are given.
inline std::string test_text(const std::string& name) {
    const std::string text = slurp(PALPATE_SOURCE_DIR "/tests/texts/" + name);
    return text.empty() ? throw std::invalid_argument("tests/texts has no " + name) : text;
}

/// The study that most tests run.
inline const std::string kFourTrials = PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml";
inline std::string four_trials() {
    return slurp(kFourTrials);
}

/// The rows of a table of tests/texts: fields with tabs between, in which \n is the end of a line;
/// a line that begins with # is a remark.
inline std::vector<std::vector<std::string>> test_rows(const std::string& name) {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : lines_in(test_text(name))) {
        if (line.empty() || line.front() == '#') {
            continue;
        }
        for (std::string& field : rows.emplace_back(split(line, '\t'))) {
            for (std::size_t at = 0; (at = field.find("\\n", at)) != std::string::npos;) {
                field.replace(at, 2, "\n");
            }
        }
    }
    return rows;
}

/// `first`, and the words of a line with blanks between.
inline std::vector<std::string> words_of(const std::string& first, const std::string& line) {
    std::vector<std::string> words{first};
    for (std::string& word : split(line, ' ')) {
        if (!word.empty()) {
            words.push_back(std::move(word));
        }
    }
    return words;
}

}  // namespace palpate::tests
