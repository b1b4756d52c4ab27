#include "data/csv/number_table.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/file/document.hpp"
#include "data/csv/csv_text.hpp"

namespace palpate::data {
namespace {

class Parser {
public:
    Parser(std::string_view text, std::string_view file_name) : rest_(text), file_(file_name) {
        skip_mark();
    }
    /// @param pieces  of the text; outlives this
    Parser(protocols::TextPieces& pieces, std::string_view file_name)
        : pieces_(&pieces), file_(file_name) {
        fill();
        skip_mark();
    }

    NumberTable read(std::span<const std::string_view> wanted,
                     std::span<const std::string_view> optional,
                     std::span<const std::string_view> texts) {
        NumberTable table = begin(wanted, optional, texts);
        while (next_line()) {
            read_row(table);
        }
        return table;
    }

    /// Reads the head. @return the table without rows
    NumberTable begin(std::span<const std::string_view> wanted,
                      std::span<const std::string_view> optional,
                      std::span<const std::string_view> texts) {
        if (!next_line()) {
            fail(1, fmt::format("the file is empty: give a head with the columns {}",
                                fmt::join(wanted, ",")));
        }
        read_head();
        NumberTable table;
        for (const std::string_view name : wanted) {
            add_column(table, name);
        }
        const bool all = std::all_of(optional.begin(), optional.end(), [this](auto name) {
            return std::find(head_.begin(), head_.end(), name) != head_.end();
        });
        if (all) {
            for (const std::string_view name : optional) {
                add_column(table, name);
            }
        }
        for (const std::string_view name : texts) {
            if (const auto place = place_of(name)) {
                table.text_columns.emplace_back(name);
                text_places_.push_back(*place);
            }
        }
        return table;
    }

    /// Reads the next row instead of the one in `table`. @return false at the end
    bool next_row(NumberTable& table) {
        table.values.clear();
        table.characters.clear();
        table.lines.clear();
        if (!next_line()) {
            return false;
        }
        read_row(table);
        return true;
    }

private:
    void skip_mark() {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (rest_.starts_with(kByteOrderMark)) {
            rest_.remove_prefix(kByteOrderMark.size());
        }
    }

    /// More of the text behind `rest_`. @return false: there is no more
    bool fill() {
        if (pieces_ == nullptr) {
            return false;
        }
        buffer_.erase(0, buffer_.size() - rest_.size());
        const bool more = pieces_->next(buffer_);
        rest_ = buffer_;
        return more;
    }

    [[noreturn]] void fail(std::size_t line, const std::string& what) const {
        throw CsvError(fmt::format("{}:{}: {}", file_, line, what));
    }

    /// What a spreadsheet writes where it was not asked for commas and UTF-8 is named as such.
    void read_head() {
        head_line_ = line_;
        if (!is_utf8(line_)) {
            fail(number_,
                 "the head is not UTF-8 (a spreadsheet may write UTF-16 or a code page): save "
                 "the table as CSV UTF-8");
        }
        if (trimmed(line_, kBlank).find('\r') != std::string_view::npos) {
            fail(number_,
                 "lines end with a carriage return alone (CR): save the table with lines that end "
                 "with LF or CR LF");
        }
        for (const Field& name : fields_of(head_line_)) {
            head_.push_back(name.text);
            head_characters_.push_back(name.character);
        }
        const std::size_t other = line_.find_first_of(";\t");
        if (head_.size() == 1 && other != std::string_view::npos) {
            fail(number_, fmt::format("the fields are parted by {}, not by commas: save the table "
                                      "with commas, and with a point for decimals",
                                      line_[other] == ';' ? "semicolons" : "tabs"));
        }
    }

    /// Where the head has it. Which of two columns of one name is meant nobody can tell.
    [[nodiscard]] std::optional<std::size_t> place_of(std::string_view name) const {
        const auto first = std::find(head_.begin(), head_.end(), name);
        if (first == head_.end()) {
            return std::nullopt;
        }
        const auto place = static_cast<std::size_t>(first - head_.begin());
        if (const auto second = std::find(first + 1, head_.end(), name); second != head_.end()) {
            fail_at(head_characters_[static_cast<std::size_t>(second - head_.begin())],
                    fmt::format("the head names the column {} twice, first as its column {}: "
                                "rename or leave out the one that is not meant",
                                name, place + 1));
        }
        return place;
    }

    [[noreturn]] void fail_at(std::size_t character, const std::string& what) const {
        throw CsvError(fmt::format("{}:{}:{}: {}", file_, number_, character, what));
    }

    /// Bytes of the next row, to its line break or the end of the text.
    std::size_t row_length() {
        const std::size_t line = std::min(rest_.find('\n'), rest_.size());
        if (line < rest_.size() && rest_.substr(0, line).find('"') == std::string_view::npos) {
            return line;
        }
        RowEnd end;
        std::size_t length = end.in(rest_);
        while (length == std::string_view::npos && fill()) {
            length = end.in(rest_);
            if (std::min(length, rest_.size()) > kMaxLine) {
                break;
            }
        }
        if (length == std::string_view::npos && end.open()) {
            fail(number_ + 1, "a quote opens in this row and does not end: end it, or take it out");
        }
        if (pieces_ != nullptr && std::min(length, rest_.size()) > kMaxLine) {
            fail(number_ + 1,
                 fmt::format("the line is longer than {} bytes: give a row a line", kMaxLine));
        }
        return std::min(length, rest_.size());
    }

    /// The next row that is not blank: a line, or several where quotes hold line breaks.
    bool next_line() {
        while (!rest_.empty() || fill()) {
            const std::size_t end = row_length();
            number_ += std::exchange(breaks_, 0) + 1;
            line_ = rest_.substr(0, end);
            breaks_ = static_cast<std::size_t>(std::ranges::count(line_, '\n'));
            rest_.remove_prefix(std::min(end + 1, rest_.size()));
            if (!trimmed(line_, kBlank).empty()) {
                return true;
            }
        }
        return false;
    }

    void add_column(NumberTable& table, std::string_view name) {
        const auto place = place_of(name);
        if (!place) {
            fail(number_, fmt::format("there is no column {}: the head is \"{}\"; add the column",
                                      name, fmt::join(head_, ",")));
        }
        table.columns.emplace_back(name);
        places_.push_back(*place);
    }

    void read_row(NumberTable& table) {
        const std::vector<Field> fields = fields_of(line_);
        if (fields.size() != head_.size()) {
            fail(number_,
                 fmt::format("the row has {} fields, the head {}: give one for each column",
                             fields.size(), head_.size()));
        }
        for (std::size_t i = 0; i < places_.size(); ++i) {
            const Field& field = fields[places_[i]];
            table.values.push_back(number(field, table.columns[i]));
            table.characters.push_back(static_cast<std::uint32_t>(field.character));
        }
        for (const std::size_t place : text_places_) {
            const std::string& text = table.texts.emplace_back(plain_text(fields[place].text));
            if (!is_utf8(text)) {
                fail_at(fields[place].character,
                        fmt::format("{} is not UTF-8 (a spreadsheet may write a code page): save "
                                    "the table as CSV UTF-8",
                                    head_[place]));
            }
            if (text.find('\0') != std::string::npos) {
                fail_at(fields[place].character,
                        fmt::format("{} holds a NUL byte: take it out", head_[place]));
            }
            table.text_characters.push_back(static_cast<std::uint32_t>(fields[place].character));
        }
        table.lines.push_back(number_);
    }

    [[nodiscard]] double number(const Field& field, std::string_view column) const {
        std::string_view digits = field.text;
        if (digits.starts_with('+') && !digits.starts_with("+-")) {
            digits.remove_prefix(1);
        }
        const auto value = parsed<double>(digits);
        if (!value || !std::isfinite(*value)) {
            fail_at(field.character,
                    fmt::format("{} is \"{}\", not a finite number: give one, with a "
                                "point for decimals",
                                column, field.text.substr(0, 40)));
        }
        return *value;
    }

    protocols::TextPieces* pieces_ = nullptr;  ///< null: all is in rest_
    std::string buffer_;                       ///< what of the pieces is held
    std::string_view rest_;
    std::string_view file_;
    std::string head_line_;
    std::string_view line_;
    std::size_t number_ = 0;  ///< of the line that the row begins in
    std::size_t breaks_ = 0;  ///< of lines, in the row
    std::vector<std::string_view> head_;
    std::vector<std::size_t> head_characters_;
    std::vector<std::size_t> places_;  ///< of the table's columns among the fields
    std::vector<std::size_t> text_places_;
};

/// What reads a text names the file and why it cannot.
template <class Read>
auto as_table(const Read& read) {
    try {
        return read();
    } catch (const protocols::ProtocolError& e) {
        throw CsvError(e.what());
    }
}

std::string text_of(const std::filesystem::path& file) {
    return as_table([&] { return protocols::read_text(file); });
}

}  // namespace

std::string NumberTable::place(std::size_t row, std::size_t column) const {
    return fmt::format("{}:{}", lines[row], characters[row * columns.size() + column]);
}

std::optional<std::string_view> NumberTable::text(std::size_t row, std::string_view column) const {
    const auto found = std::find(text_columns.begin(), text_columns.end(), column);
    return found == text_columns.end()
             ? std::nullopt
             : std::optional<std::string_view>(
                   texts[row * text_columns.size() +
                         static_cast<std::size_t>(found - text_columns.begin())]);
}

std::string NumberTable::text_place(std::size_t row, std::string_view column) const {
    const auto at =
        static_cast<std::size_t>(std::ranges::find(text_columns, column) - text_columns.begin());
    return fmt::format("{}:{}", lines[row], text_characters[row * text_columns.size() + at]);
}

NumberTable parse_numbers(std::string_view text,
                          std::string_view file_name,
                          std::span<const std::string_view> wanted,
                          std::span<const std::string_view> optional,
                          std::span<const std::string_view> texts) {
    return Parser(text, file_name).read(wanted, optional, texts);
}

NumberTable read_numbers(const std::filesystem::path& file,
                         std::span<const std::string_view> wanted,
                         std::span<const std::string_view> optional,
                         std::span<const std::string_view> texts) {
    return parse_numbers(text_of(file), file.string(), wanted, optional, texts);
}

RereadableText::RereadableText(const std::filesystem::path& file)
    : name_(file.string()), place_(file) {
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) {
        return;
    }
    as_table([&] {
        protocols::TextPieces pieces(file);
        copy_.reset(std::tmpfile());
        std::string piece;
        while (copy_ && pieces.next(piece) &&
               std::fwrite(piece.data(), 1, piece.size(), copy_.get()) == piece.size()) {
            piece.clear();
        }
    });
    if (!copy_ || std::fflush(copy_.get()) != 0 || std::ferror(copy_.get()) != 0) {
        const std::string why = std::generic_category().message(errno);
        throw CsvError(fmt::format(
            "{}:1: cannot be copied to a file without a name: {}; check the space in /tmp, or give "
            "a file on a disk",
            name_, why));
    }
    place_ = fmt::format("/proc/self/fd/{}", ::fileno(copy_.get()));
}

NumberTable read_numbers(const RereadableText& text,
                         std::span<const std::string_view> wanted,
                         std::span<const std::string_view> optional,
                         std::span<const std::string_view> texts) {
    return parse_numbers(text_of(text.place()), text.name(), wanted, optional, texts);
}

struct NumberRows::Source {
    Source(const RereadableText& text, std::span<const std::string_view> wanted)
        : pieces(text.place()), parser(pieces, text.name()), row(parser.begin(wanted, {}, {})) {}

    protocols::TextPieces pieces;
    Parser parser;
    NumberTable row;
};

NumberRows::NumberRows(const RereadableText& text, std::span<const std::string_view> wanted)
    : source_(as_table([&] { return std::make_unique<Source>(text, wanted); })) {}

bool NumberRows::next() {
    return as_table([this] { return source_->parser.next_row(source_->row); });
}

double NumberRows::at(std::size_t column) const {
    return source_->row.at(0, column);
}

std::size_t NumberRows::line() const {
    return source_->row.lines[0];
}

NumberRows::~NumberRows() = default;

}  // namespace palpate::data
