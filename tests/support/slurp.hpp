#pragma once

#include "tests/support/std.hpp"

namespace palpate::tests {

/// The words of a command, or names.
using Words = std::vector<std::string>;

/// `words`, and more after them.
[[nodiscard]] inline Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// All bytes of a file; none where there is no such file.
inline std::string slurp(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return std::move(text).str();
}

/// Every file below a folder: its name and its bytes.
inline std::string everything(const std::filesystem::path& folder) {
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            files.insert(std::filesystem::relative(entry.path(), folder).string() + '\n' +
                         slurp(entry.path()));
        }
    }
    return fmt::format("{}", fmt::join(files, "\n"));
}

/// The lines of a text.
inline Words lines_in(const std::string& text) {
    Words lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        lines.push_back(std::move(line));
    }
    return lines;
}

/// What stands between the separators of a line, the empty too.
inline Words split(const std::string& line, char separator = ',') {
    Words fields{""};
    for (const char c : line) {
        if (c == separator) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

/// How often `what` is in a text.
inline std::size_t count_of(const std::string& text, std::string_view what) {
    std::size_t n = 0;
    for (std::size_t at = text.find(what); at != std::string::npos;
         at = text.find(what, at + what.size())) {
        ++n;
    }
    return n;
}

/// What stands between `open` and the next `close`, every time.
inline Words between(const std::string& text, std::string_view open, std::string_view close) {
    Words found;
    for (std::size_t at = text.find(open); at != std::string::npos;) {
        const std::size_t begin = at + open.size();
        const std::size_t end = text.find(close, begin);
        if (end == std::string::npos) {
            break;
        }
        found.push_back(text.substr(begin, end - begin));
        at = text.find(open, end + close.size());
    }
    return found;
}

/// What stands behind the first `open` up to the next `close`, or to the end; empty where there is
/// no `open`.
inline std::string behind(const std::string& text,
                          std::string_view open,
                          std::string_view close = "\n") {
    const std::size_t at = text.find(open);
    const std::size_t begin = at + open.size();
    return at == std::string::npos ? "" : text.substr(begin, text.find(close, begin) - begin);
}

/// "01 FF".
inline std::string hex_of(std::span<const std::uint8_t> bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) {
        text += fmt::format("{}{:02X}", text.empty() ? "" : " ", byte);
    }
    return text;
}
/// And back.
inline std::vector<std::uint8_t> bytes_of_hex(const std::string& text) {
    std::vector<std::uint8_t> bytes;
    for (const std::string& byte : split(text, ' ')) {
        bytes.push_back(static_cast<std::uint8_t>(std::stoi(byte, nullptr, 16)));
    }
    return bytes;
}

/// Rows of a CSV without quotes, its head first.
inline std::vector<Words> csv_rows(const std::string& csv, char separator = ',') {
    std::vector<Words> rows;
    for (const std::string& line : lines_in(csv)) {
        rows.push_back(split(line, separator));
    }
    return rows;
}

/// The same without the head.
inline std::vector<Words> csv_body(const std::string& csv) {
    auto rows = csv_rows(csv);
    rows.erase(rows.begin(), rows.begin() + (rows.empty() ? 0 : 1));
    return rows;
}

/// The same by the names of its columns. @param names  none: the head is first
inline std::vector<std::map<std::string, std::string>> csv_records(const std::string& csv,
                                                                   char separator = ',',
                                                                   Words names = {}) {
    std::vector<std::map<std::string, std::string>> records;
    for (Words& row : csv_rows(csv, separator)) {
        if (names.empty()) {
            names = std::move(row);
            continue;
        }
        auto& record = records.emplace_back();
        for (std::size_t i = 0; i < std::min(row.size(), names.size()); ++i) {
            record[names[i]] = std::move(row[i]);
        }
    }
    return records;
}

/// `text` with the first `from` replaced. @throws std::logic_error if it is not there
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) {
        throw std::logic_error("not in the text: " + std::string(from));
    }
    return text.replace(at, from.size(), to);
}
/// The same with every one of them.
inline std::string all_replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
        text.replace(at, from.size(), to);
    }
    return text;
}
/// The first of each replaced, once after the other.
inline std::string edited(std::string text,
                          const std::vector<std::pair<std::string, std::string>>& edits) {
    for (const auto& [from, to] : edits) {
        text = replaced(std::move(text), from, to);
    }
    return text;
}

}  // namespace palpate::tests
