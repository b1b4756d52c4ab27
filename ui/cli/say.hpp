#pragma once

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace palpate::ui {

/// Writes at once. That nobody reads it any more, or that a log's disk is full, is no error here: a session
/// goes on without listeners.
inline void say_to(std::FILE* file, const std::string& text) noexcept {
    static_cast<void>(std::fwrite(text.data(), 1, text.size(), file));
    static_cast<void>(std::fflush(file));
}

/// What a session says, to standard output.
template <class... Values>
void say(fmt::format_string<Values...> text, Values&&... values) {
    say_to(stdout, fmt::format(text, std::forward<Values>(values)...));
}

/// What somebody should know, to standard error: "palpate: ", the text, and the end of the line.
template <class... Values>
void warn(fmt::format_string<Values...> text, Values&&... values) {
    say_to(stderr, "palpate: " + fmt::format(text, std::forward<Values>(values)...) + '\n');
}

}  // namespace palpate::ui
