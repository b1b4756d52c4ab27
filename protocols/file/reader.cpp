#include "protocols/file/reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include <fmt/format.h>

#include "protocols/file/keys.hpp"
#include "protocols/file/protocol_file.hpp"

namespace palpate::protocols {
namespace {

bool is_name(std::string_view text) {
    constexpr std::size_t kLongest = 64;
    return !text.empty() && text.size() <= kLongest &&
           std::all_of(text.begin(), text.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
           });
}

bool is_free_text(std::string_view text) {
    constexpr std::size_t kLongest = 200;
    return !text.empty() && text.size() <= kLongest &&
           std::all_of(text.begin(), text.end(),
                       [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f; });
}

/// Lines end with \n alone; each is free text, or empty to leave room.
bool is_instruction(std::string_view text) {
    return text.size() <= kMostInstruction &&
           std::count(text.begin(), text.end(), '\n') <
               static_cast<std::ptrdiff_t>(kMostInstructionLines) &&
           std::any_of(text.begin(), text.end(), [](char c) { return c != ' ' && c != '\n'; }) &&
           std::all_of(text.begin(), text.end(), [](char c) {
               return c == '\n' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
           });
}

/// "[design]", "[instructions.en]", or "[[object]] 3" for the third of them.
std::string heading(const std::string& path) {
    const std::size_t dot = path.find('.');
    return dot == std::string::npos || path[dot + 1] < '0' || path[dot + 1] > '9'
             ? fmt::format("[{}]", path)
             : fmt::format("[[{}]] {}", path.substr(0, dot), path.substr(dot + 1));
}

/// One value into one member. Says what is wrong, or nothing.
template <class Record>
class Cell {
public:
    Cell(const Key<Record>& key, const Value& value) : key_(key), value_(value) {}

    [[nodiscard]] std::string read(double& out) const {
        const auto number = as_number(value_);
        if (!number) {
            return wrong_kind("a number");
        }
        if (!in_range(*number)) {
            return out_of_range(value_);
        }
        out = to_si(*number);
        return {};
    }

    [[nodiscard]] std::string read(std::uint64_t& out) const {
        const auto* integer = std::get_if<std::int64_t>(&value_.data);
        if (integer == nullptr) {
            return wrong_kind("an integer");
        }
        if (*integer < 0 || !in_range(static_cast<double>(*integer))) {
            return out_of_range(value_);
        }
        out = static_cast<std::uint64_t>(*integer);
        return {};
    }

    [[nodiscard]] std::string read(bool& out) const {
        const auto* flag = std::get_if<bool>(&value_.data);
        if (flag == nullptr) {
            return wrong_kind("true or false");
        }
        out = *flag;
        return {};
    }

    [[nodiscard]] std::string read(std::string& out) const {
        const auto* text = std::get_if<std::string>(&value_.data);
        if (text == nullptr) {
            return wrong_kind("text in quotes");
        }
        if (key_.text == Text::name && !is_name(*text)) {
            return fmt::format("{} is {}: give 1 to 64 letters a-z, digits and _", key_.name,
                               shown(*text));
        }
        if (key_.text == Text::free && !is_free_text(*text)) {
            return fmt::format("{} is {}: give 1 to 200 bytes of text on one line", key_.name,
                               shown(*text));
        }
        if (key_.text == Text::lines && !is_instruction(*text)) {
            return fmt::format(
                "{} is {}, {} bytes: give 1 to {} bytes of text in at most {} lines, without "
                "tabs",
                key_.name, shown(*text), text->size(), kMostInstruction, kMostInstructionLines);
        }
        out = *text;
        return {};
    }

    template <class Enumeration>
    requires std::is_enum_v<Enumeration>
    [[nodiscard]] std::string read(Enumeration& out) const {
        const auto* text = std::get_if<std::string>(&value_.data);
        if (text == nullptr) {
            return wrong_kind(range_of(key_));
        }
        const auto words = words_of(Enumeration{});
        const auto found = std::find(words.begin(), words.end(), *text);
        if (found == words.end()) {
            return fmt::format("{} is {}, give {}{}", key_.name, shown(*text), range_of(key_),
                               suggestion(*text, words, ""));
        }
        out = static_cast<Enumeration>(found - words.begin());
        return {};
    }

    [[nodiscard]] std::string read(engine::Vec2& out) const {
        const auto* array = std::get_if<Array>(&value_.data);
        if (array == nullptr || array->size() != 2) {
            return wrong_kind("two numbers as [x, y]");
        }
        const auto x = as_number((*array)[0]);
        const auto y = as_number((*array)[1]);
        if (!x || !y) {
            return wrong_kind("two numbers as [x, y]");
        }
        if (!in_range(*x)) {
            return out_of_range((*array)[0]);
        }
        if (!in_range(*y)) {
            return out_of_range((*array)[1]);
        }
        out = engine::Vec2{to_si(*x), to_si(*y)};
        return {};
    }

private:
    /// Integers are numbers, too.
    static std::optional<double> as_number(const Value& value) {
        if (const auto* integer = std::get_if<std::int64_t>(&value.data)) {
            return static_cast<double>(*integer);
        }
        if (const auto* number = std::get_if<double>(&value.data)) {
            return *number;
        }
        return std::nullopt;
    }

    /// False for NaN as well.
    [[nodiscard]] bool in_range(double value) const {
        return value <= key_.highest && (key_.above ? value > key_.lowest : value >= key_.lowest);
    }

    /// A quotient is rounded once: 40 mm is the double that 0.04 is. Adding 0 makes -0 into 0.
    [[nodiscard]] double to_si(double value) const { return value / key_.per_si + 0.0; }

    [[nodiscard]] std::string wrong_kind(std::string_view wanted) const {
        return fmt::format("{} is {} ({}): give {}", key_.name, shown(value_), kind_of(value_),
                           wanted);
    }

    [[nodiscard]] std::string out_of_range(const Value& value) const {
        return fmt::format("{} is {}: give {}", key_.name, shown(value), range_of(key_));
    }

    const Key<Record>& key_;
    const Value& value_;
};

}  // namespace

void Problems::throw_if_any(std::string_view file_name) const {
    if (none()) {
        return;
    }
    constexpr std::size_t kMost = 100;  // who sees so many mends one and looks again
    std::string text;
    std::size_t told = 0;
    for (const auto& [at, what] : found_) {
        if (++told > kMost) {
            text += fmt::format("\n{}:{}:{}: {} more are not told", file_name, at.line, at.column,
                                found_.size() - kMost);
            break;
        }
        text += fmt::format("{}{}:{}:{}: {}", text.empty() ? "" : "\n", file_name, at.line,
                            at.column, what);
    }
    throw ProtocolError(text);
}

bool Places::has(const std::string& path) const {
    return places_.contains(path);
}

Position Places::of(std::string path) const {
    for (;;) {
        if (const auto found = places_.find(path); found != places_.end()) {
            return found->second;
        }
        const std::size_t dot = path.rfind('.');
        if (dot == std::string::npos) {
            return {};
        }
        path.resize(dot);
    }
}

Position spoken_of(const Table& table, std::string_view sentence, const Position& otherwise) {
    const std::string_view word = sentence.substr(0, sentence.find(' '));
    const auto entry = std::find_if(table.begin(), table.end(),
                                    [word](const Entry& one) { return one.key == word; });
    return entry == table.end() ? otherwise : entry->value.at;
}

template <class Record>
void Reader::read(const Table& table,
                  const std::string& path,
                  const Position& at,
                  Record& record,
                  const Beyond& beyond) {
    const auto keys = keys_of<Record>();
    places_.note(path, at);
    std::vector<std::string_view> known;
    for (const Key<Record>& key : keys) {
        known.push_back(key.name);
    }
    const auto& elsewhere = beyond.known_elsewhere;
    known.insert(known.end(), elsewhere.begin(), elsewhere.end());
    std::set<std::string_view> seen;
    for (const Entry& entry : table) {
        if (std::find(elsewhere.begin(), elsewhere.end(), entry.key) != elsewhere.end()) {
            continue;
        }
        const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key<Record>& row) {
            return row.name == entry.key;
        });
        if (key == keys.end()) {
            problems_.add(entry.at, fmt::format("unknown key {} in {}{}", shown(entry.key),
                                                heading(path), suggestion(entry.key, known)));
            continue;
        }
        seen.insert(key->name);
        places_.note(path + '.' + entry.key, entry.value.at);
        const std::string what = std::visit(
            [&](auto member) { return Cell<Record>(*key, entry.value).read(record.*member); },
            key->member);
        if (!what.empty()) {
            problems_.add(entry.value.at, what);
        }
    }
    for (const Key<Record>& key : keys) {
        if (beyond.complete && key.need == Need::required && !seen.contains(key.name)) {
            problems_.add(at, fmt::format("{} lacks the key {}: add it ({}; {})", heading(path),
                                          key.name, range_of(key), key.meaning));
        }
    }
}

template void Reader::read(
    const Table&, const std::string&, const Position&, Protocol&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, ApparatusSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, OutlineSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, ObjectSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, FrictionSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, SafetySpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, InvalidSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, ExclusionSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, DesignSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, TimingSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, ObserverSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, ResponseSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, MaskingSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, InstructionTexts&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, AdaptiveSpec&, const Beyond&);
template void Reader::read(
    const Table&, const std::string&, const Position&, RunSpec&, const Beyond&);

}  // namespace palpate::protocols
