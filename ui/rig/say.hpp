#pragma once

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "engine/base/text.hpp"

namespace palpate::ui {

/// The one way to a terminal: all that people read goes out here, and nothing in it is an order to
/// the terminal (engine/base/plain_text.hpp). Writes at once. That nobody reads it any more, or
/// that a log's disk is full, is no error here: a session goes on without listeners.
inline void say_to(std::FILE* file, const std::string& text) noexcept {
    const std::string shown = plain(text, Lines::kept);
    static_cast<void>(std::fwrite(shown.data(), 1, shown.size(), file));
    static_cast<void>(std::fflush(file));
}

/// What a command says, to standard output.
template <class... Values>
void say(fmt::format_string<Values...> text, Values&&... values) {
    say_to(stdout, fmt::format(text, std::forward<Values>(values)...));
}

/// What somebody should know, to standard error: "palpate: ", the text, and the end of the line.
template <class... Values>
void warn(fmt::format_string<Values...> text, Values&&... values) {
    say_to(stderr, "palpate: " + fmt::format(text, std::forward<Values>(values)...) + '\n');
}

/// An alarm that is heard where somebody sits at a terminal: its bell.
inline void ring() noexcept {
    if (isatty(STDERR_FILENO) == 1) {
        static_cast<void>(std::fputc('\a', stderr));
    }
}

}  // namespace palpate::ui
