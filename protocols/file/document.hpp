#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/base/descriptor.hpp"

/// A TOML file as a plain tree with positions. Only document.cpp knows the TOML library.
namespace palpate::protocols {

/// What is wrong with a file. what() holds one line per problem, in the order of the file:
///
///     file:line:column: what is wrong, the value, what to do
class ProtocolError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Where something stands in a text, both counted from 1.
struct Position {
    std::size_t line = 1;
    std::size_t column = 1;

    friend auto operator<=>(const Position&, const Position&) = default;
};

struct Value;
struct Entry;
using Array = std::vector<Value>;
using Table = std::vector<Entry>;  ///< in the order of the file

/// A date or time: no key of ours takes one.
struct Moment {};

/// A value of a file and where it begins.
struct Value {
    Position at{};
    std::variant<bool, std::int64_t, double, std::string, Moment, Array, Table> data;
};

/// A key of a table and its value.
struct Entry {
    std::string key;
    Position at{};  ///< of the key
    Value value;
};

/// "an integer", "a table", ... for messages.
[[nodiscard]] std::string_view kind_of(const Value& value);
/// The value for a message: on one line, shortened, in quotes if it is text.
[[nodiscard]] std::string shown(const Value& value);
[[nodiscard]] std::string shown(std::string_view text);

/// The largest text that is parsed, bytes: hundreds of times what a protocol says.
inline constexpr std::size_t kMaxDocument = 4U << 20U;
/// The most parts of a dotted key or table's name, and the most arrays and tables in one another.
/// TOML has no bound, and a tree of 15,000 levels would use up the stack.
inline constexpr std::size_t kMaxLevels = 16;

/// Parses TOML; everything that is TOML enters here. @param file_name  for messages
/// @throws ProtocolError at the first error of syntax, or at what is too long or too deep
[[nodiscard]] Table parse_document(std::string_view text, std::string_view file_name);

/// The longest text that is read, bytes: some hours of a trajectory at 1 kHz.
inline constexpr std::size_t kMaxText = std::size_t{1} << 30U;

/// The whole text of a file, a pipe or a terminal. No name makes it wait for ever or fill the
/// memory: a pipe has to give something every 10 s.
/// @param max  bytes; a longer text is refused
/// @throws ProtocolError "file:1:1: cannot be read: why; check the path"
[[nodiscard]] std::string read_text(const std::filesystem::path& file, std::size_t max = kMaxText);

/// Of toml++, which this program was compiled with.
[[nodiscard]] std::string toml_version();

/// read_text() piece by piece: no more of it is held than one.
class TextPieces {
public:
    /// @throws as read_text(), as next() does
    explicit TextPieces(const std::filesystem::path& file, std::size_t max = kMaxText);

    /// The next piece, appended to `text`. @return false at the end
    [[nodiscard]] bool next(std::string& text);

private:
    std::string file_;
    std::size_t max_;
    std::size_t read_ = 0;  ///< bytes
    Descriptor text_{};
};

}  // namespace palpate::protocols
