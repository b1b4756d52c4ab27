#pragma once

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace palpate::ui {

/// The one way to a terminal: all that people read goes out here, and nothing in it is an order to
/// the terminal (engine/base/plain_text.hpp). Writes at once. That nobody reads it any more, or
/// that a log's disk is full, is no error here: a session goes on without listeners.
void say_to(std::FILE* file, const std::string& text) noexcept;

/// From here on nobody who does not read (a pager, a terminal after Ctrl+S) holds up who speaks on
/// standard output or standard error: up to 64 kB wait for the reader, the rest is left out, and
/// how many texts were is said there.
void say_in_passing();

/// After that, at the end of the program: whoever reads slowly may read to the end, unless a signal
/// comes, or came; then what nobody read is counted on standard error.
/// @return all that was said could be written
[[nodiscard]] bool let_readers_read() noexcept;

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
void ring() noexcept;

}  // namespace palpate::ui
