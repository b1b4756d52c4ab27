#pragma once

#include "tests/support/slurp.hpp"

namespace palpate::tests {

/// What a file of tests/texts holds: studies, scripts and tables that tests are given.
inline std::string test_text(const std::string& name) {
    const std::string text = slurp(PALPATE_SOURCE_DIR "/tests/texts/" + name);
    return text.empty() ? throw std::invalid_argument("tests/texts has no " + name) : text;
}

/// The file of one of its scripts.
inline std::string script(const std::string& name) {
    return PALPATE_SOURCE_DIR "/tests/texts/scripts/" + name;
}

/// The study that most tests run.
inline const std::string kFourTrials = PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml";
inline std::string four_trials() {
    return slurp(kFourTrials);
}

/// The rows of a table of tests/texts: fields with tabs between, in which \n is the end of a line;
/// a line that begins with # is a remark.
inline std::vector<Words> test_rows(const std::string& name) {
    std::vector<Words> rows;
    for (const std::string& line : lines_in(test_text(name))) {
        if (line.empty() || line.front() == '#') {
            continue;
        }
        for (std::string& field : rows.emplace_back(split(line, '\t'))) {
            field = all_replaced(std::move(field), "\\n", "\n");
        }
    }
    return rows;
}

/// `first`, and the words of a line with blanks between, in which a name in braces is what is meant.
inline Words words_of(const std::string& first,
                      const std::string& line,
                      const std::map<std::string, std::string>& meant = {}) {
    Words words = joined({first}, split(line, ' '));
    std::erase(words, "");
    for (std::string& word : words) {
        for (const auto& [name, text] : meant) {
            word = all_replaced(std::move(word), name, text);
        }
    }
    return words;
}

}  // namespace palpate::tests
