#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ui/cli/options.hpp"

namespace CLI {
class App;
}

/// Private to the command line.
namespace palpate::ui {

/// The values that `command` writes to, and which become `chosen` when it is the one given.
template <class T, class Command>
T& options_of(Command* command, Options& chosen) {
    auto options = std::make_shared<T>();
    command->callback([options, &chosen] { chosen = *options; });
    return *options;
}

/// A CLI check of words that are kept: they must be UTF-8, as everything that reads them takes for granted.
[[nodiscard]] std::string kept_text(const std::string& words);

/// A CLI check of a word that is one of a few; what it says of another names the nearest.
using WordCheck = std::function<std::string(const std::string&)>;
[[nodiscard]] WordCheck one_of(std::vector<std::string> words);

/// The commands on files that are there: what they hold, what is noted in them, what goes out of them.
void add_data_commands(CLI::App& app, Options& chosen);

}  // namespace palpate::ui
