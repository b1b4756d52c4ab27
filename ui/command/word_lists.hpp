#pragma once

#include <string>
#include <vector>

#include "ui/command/command.hpp"

/// What other programs want to know of the commands, out of the same table that reads the command
/// line.
namespace palpate::ui {

/// The manual page, for man(1): every command with every word, its meaning, default and range.
/// @param version  "0.1.0"
[[nodiscard]] std::string man_page(const std::vector<Command>& commands,
                                   const std::string& version);

/// A script for bash that completes commands, options, and values that are one of a few. Where any
/// text is right bash offers files.
[[nodiscard]] std::string bash_completion(const std::vector<Command>& commands);

}  // namespace palpate::ui
