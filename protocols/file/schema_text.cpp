#include <array>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/file/schema.hpp"

namespace palpate::protocols {
namespace {

/// Empty if `si` is no quotient.
std::string shortest(double si, double per_si) {
    constexpr int kNeighbours = 2;  // si * per_si is at most one rounding away from y
    std::string best;
    double y = si * per_si;
    for (int i = 0; i < kNeighbours; ++i) {
        y = std::nextafter(y, -std::numeric_limits<double>::infinity());
    }
    for (int i = -kNeighbours; i <= kNeighbours; ++i) {
        const std::string text = fmt::format("{}", y + 0.0);
        if (y / per_si == si && (best.empty() || text.size() < best.size())) {
            best = text;
        }
        y = std::nextafter(y, std::numeric_limits<double>::infinity());
    }
    return best;
}

/// The value of a slot as text of a file; nothing for none.
struct Text {
    double per_si = 1.0;
    int dimension = 3;  ///< of a point

    using Maybe = std::optional<std::string>;

    Maybe operator()(const double* value) const { return toml_text(*value, per_si); }
    Maybe operator()(const std::optional<double>* value) const {
        return *value ? Maybe(toml_text(**value, per_si)) : std::nullopt;
    }
    Maybe operator()(const Whole& value) const {
        const auto number = value.get(value.at);
        return number ? Maybe(fmt::format("{}", *number)) : std::nullopt;
    }
    Maybe operator()(const OneOf& value) const {
        const auto number = value.number.get(value.number.at);
        return number ? Maybe(fmt::format("\"{}\"", value.words[static_cast<std::size_t>(*number)]))
                      : std::nullopt;
    }
    Maybe operator()(const bool* value) const { return *value ? "true" : "false"; }
    Maybe operator()(const std::string* value) const { return toml_text(*value); }
    Maybe operator()(const engine::Vec2* value) const {
        return fmt::format("[{}, {}]", toml_text(value->x, per_si), toml_text(value->y, per_si));
    }
    Maybe operator()(const std::optional<engine::Vec2>* value) const {
        return *value ? (*this)(&**value) : std::nullopt;
    }
    Maybe operator()(const engine::Vec3* value) const {
        return dimension == 2 ? fmt::format("[{}, {}]", toml_text(value->x), toml_text(value->y))
                              : fmt::format("[{}, {}, {}]", toml_text(value->x),
                                            toml_text(value->y), toml_text(value->z));
    }
    Maybe operator()(const PointList* value) const {
        return Text{per_si, value->dimension}.list(value->values);
    }
    template <class T>
    Maybe operator()(const std::vector<T>* value) const {
        return list(*value);
    }
    template <class T>
    [[nodiscard]] Maybe list(const std::vector<T>& values) const {
        if (values.empty()) {
            return std::nullopt;
        }
        std::vector<std::string> texts;
        for (const T& value : values) {
            texts.push_back((*this)(&value).value_or(""));
        }
        return fmt::format("[{}]", fmt::join(texts, ", "));
    }
};

std::optional<std::string> text_of(const Key& key, void* record) {
    const Slot slot = key.slot(record);
    const auto* points = std::get_if<PointList*>(&slot);
    if (points != nullptr && key.form == Form::point) {
        return (*points)->values.empty()
                 ? std::nullopt
                 : Text{1.0, (*points)->dimension}(&(*points)->values.front());
    }
    return std::visit(Text{key.per_si}, slot);
}

std::string words_text(WordList words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        text += fmt::format("{}\"{}\"",
                            i == 0                 ? ""
                            : i + 1 < words.size() ? ", "
                                                   : " or ",
                            words[i]);
    }
    return text;
}

/// What kind of value a slot takes, for the reference.
struct RangeText {
    const Key& key;

    std::string operator()(const OneOf& choice) const { return words_text(choice.words); }
    std::string operator()(const bool*) const { return "true or false"; }
    std::string operator()(const std::string*) const {
        switch (key.form) {
            case Form::name:
                return "letters a-z, digits and _";
            case Form::lines:
                return fmt::format("up to {} bytes, {} lines", kMaxInstruction,
                                   kMaxInstructionLines);
            default:
                return "text";
        }
    }
    std::string operator()(const std::vector<double>*) const {
        const std::string_view kind = key.form == Form::axis        ? "axis"
                                    : key.form == Form::one_or_more ? "number or list"
                                                                    : "list of numbers";
        return std::isfinite(key.range.min) ? fmt::format("{}, {}", kind, range_of(key.range))
                                            : std::string(kind);
    }
    std::string operator()(const std::vector<std::string>*) const { return "list of names"; }
    std::string operator()(const engine::Vec2*) const { return pair(); }
    std::string operator()(const std::optional<engine::Vec2>*) const { return pair(); }
    std::string operator()(const PointList*) const {
        return key.form == Form::point ? "[x, y]" : "[[x, y], ...]";
    }
    std::string operator()(const PointGrid*) const { return "[[[x, y, z], ...], ...]"; }
    std::string operator()(const NumberGrid*) const { return "[[a, b, ...], ...]"; }
    std::string operator()(const double*) const { return range_of(key.range); }
    std::string operator()(const std::optional<double>*) const { return range_of(key.range); }
    std::string operator()(const Whole&) const { return range_of(key.range); }

private:
    [[nodiscard]] std::string pair() const {
        return std::isfinite(key.range.min) ? range_of(key.range) : "[x, y]";
    }
};

bool is_needed(const Key& key) {
    return key.need != Need::optional && key.need != Need::by_law_optional;
}

/// A number that the key itself refuses stands for none.
std::string default_of(const Key& key) {
    if (is_needed(key)) {
        return "required";
    }
    const Slot begun = key.slot(nullptr);
    if (const auto* choice = std::get_if<OneOf>(&begun)) {
        const auto number = choice->number.get(choice->number.at);
        return number ? std::string(choice->words[static_cast<std::size_t>(*number)]) : "-";
    }
    const auto* whole = std::get_if<Whole>(&begun);
    const auto number = whole == nullptr ? std::nullopt : whole->get(whole->at);
    if (number && !key.range.has(static_cast<double>(*number))) {
        return "-";
    }
    const std::string text = text_of(key, nullptr).value_or("-");
    return text == "\"\"" ? "-" : text;
}

/// How the name of a key ends, and its unit; the first that fits.
constexpr std::array<std::pair<std::string_view, std::string_view>, 31> kUnits{
    {{"mu_s", ""},  // s for static: a coefficient
     {"_mn_m_s", "mN m s"},
     {"_mm_per_n", "mm/N"},
     {"_m_per_n", "m/N"},
     {"_n_s_per_m", "N s/m"},
     {"_n_per_ms", "N/ms"},
     {"_n_per_m", "N/m"},
     {"volts_per_n_m_1", "V/(N m)"},
     {"volts_per_n_m_2", "V/(N m)"},
     {"_mm_per_s", "mm/s"},
     {"_m_per_s", "m/s"},
     {"_per_m_per_mu", "1/m"},
     {"_per_m", "1/m"},
     {"_mn_m", "mN m"},
     {"_mm", "mm"},
     {"points_m", "m"},
     {"from_m", "m"},
     {"to_m", "m"},
     {"radius_m", "m"},
     {"spacing_m", "m"},
     {"_deg", "degrees"},
     {"_ms", "ms"},
     {"_hz", "Hz"},
     {"_db", "dB"},
     {"_bits", "bit"},
     {"_g_cm2", "g cm^2"},
     {"_g", "g"},
     {"_adc", "ADC value"},
     {"_j", "J"},
     {"_n", "N"},
     {"_s", "s"}}};

/// By the end of the key's name.
std::string_view unit_of(std::string_view name) {
    for (const auto& [end, unit] : kUnits) {
        if (name.ends_with(end)) {
            return unit;
        }
    }
    return "";
}

/// A bar would end a cell.
std::string cell(std::string text) {
    for (std::size_t i = text.find('|'); i != std::string::npos; i = text.find('|', i + 2)) {
        text.insert(i, "\\");
    }
    return text;
}

}  // namespace

std::string toml_text(double si, double per_si) {
    const std::string exact = shortest(si, per_si);
    return exact.empty() ? shortest(si * per_si / per_si, per_si) : exact;
}

std::string toml_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (byte < 0x20 || byte == 0x7f) {
            quoted += fmt::format("\\u{:04x}", byte);
        } else {
            quoted += c;
        }
    }
    return quoted + '"';
}

std::string toml_lines(Keys keys, const void* record) {
    std::string text;
    for (const Key& key : keys) {
        // A slot takes a record to be filled; this one is only read.
        const auto value = text_of(key, const_cast<void*>(record));
        if (value && *value != "\"\"") {
            text += fmt::format("{} = {}\n", key.name, *value);
        }
    }
    return text;
}

std::string range_of(const Range& range) {
    if (range.max == kMaxSeed) {
        return "0 to 9223372036854775807";
    }
    const bool low = std::isfinite(range.min);
    const bool high = std::isfinite(range.max);
    if (!low) {
        return high ? fmt::format("up to {}", range.max) : "any finite number";
    }
    if (!high) {
        return range.above ? fmt::format("above {}", range.min)
                           : fmt::format("{} or more", range.min);
    }
    if (!range.above && !range.below) {
        return fmt::format("{} to {}", range.min, range.max);
    }
    return fmt::format("{}, {} {}", range_of(Range{.min = range.min, .above = range.above}),
                       range.below ? "below" : "at most", range.max);
}

std::string range_of(const Key& key) {
    return std::visit(RangeText{key}, key.slot(nullptr));
}

std::string meaning_of(const Key& key) {
    std::string text(key.meaning);
    for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at)) {
        text.erase(at, text.find(')', at) - at + 1);
        text.erase(text.rfind('[', at), 1);
    }
    return text;
}

std::string reference_text(std::span<const TableText> tables) {
    std::string text;
    for (const TableText& table : tables) {
        text += fmt::format("\n{}{}{}\n", table.heading, table.remark.empty() ? "" : "  ",
                            table.remark);
        for (const Key& key : table.keys) {
            text += fmt::format("    {:<22} {:<28} {:<11} {}\n", key.name, range_of(key),
                                default_of(key), meaning_of(key));
        }
    }
    return text;
}

std::string reference_markdown(std::span<const TableText> tables) {
    std::string text;
    for (const TableText& table : tables) {
        text += fmt::format("\n#### `{}`\n", table.heading);
        if (!table.remark.empty()) {
            text += fmt::format("\n{}\n", table.remark);
        }
        text += table.keys.empty()
                  ? ""
                  : "\n| key | unit | range | default | meaning |\n|---|---|---|---|---|\n";
        for (const Key& key : table.keys) {
            text += fmt::format("| `{}` | {} | {} | {} | {} |\n", key.name, unit_of(key.name),
                                cell(range_of(key)), cell(default_of(key)),
                                cell(std::string(key.meaning)));
        }
    }
    return text;
}

}  // namespace palpate::protocols
