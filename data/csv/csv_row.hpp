#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::data {

/// Around a field, and none of it.
inline constexpr std::string_view kBlank = " \t\r";

/// A field of a row, without blanks and quotes around it.
struct Field {
    std::string_view text;
    std::size_t character = 1;  ///< where it begins, from 1
};

/// All fields of a row.
[[nodiscard]] std::vector<Field> fields_of(std::string_view row);

/// "" inside of quotes means one of them.
[[nodiscard]] std::string plain_text(std::string_view field);

/// Looks for the end of a row: a line break outside of quotes, which open where a field begins.
class RowEnd {
public:
    /// @param text  the row from its beginning; as much as before, or more
    /// @return npos: the row goes on
    [[nodiscard]] std::size_t in(std::string_view text);
    /// A quote waits for its end.
    [[nodiscard]] bool open() const { return open_; }

private:
    std::size_t at_ = 0;
    bool blank_ = true;  ///< of the field nothing but blanks was seen
    bool quoted_ = false;
    bool open_ = false;
};

/// A row longer than this is none of a table, and would fill the memory.
inline constexpr std::size_t kMaxLine = std::size_t{1} << 20U;

}  // namespace palpate::data
