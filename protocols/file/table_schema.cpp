#include "protocols/file/table_schema.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace palpate::protocols {
namespace {

/// A basic string of TOML is one of JSON.
std::string in_quotes(std::string_view text) {
    return toml_text(std::string(text));
}

std::string number(const Range& range, std::string_view type = "number") {
    std::string text = fmt::format(R"("type": "{}")", type);
    if (std::isfinite(range.min)) {
        text +=
            fmt::format(R"(, "{}": {})", range.above ? "exclusiveMinimum" : "minimum", range.min);
    }
    if (std::isfinite(range.max)) {
        text +=
            fmt::format(R"(, "{}": {})", range.below ? "exclusiveMaximum" : "maximum", range.max);
    }
    return text;
}

std::string list_of(std::string_view item, std::size_t least = 0, std::size_t max = 0) {
    std::string text = fmt::format(R"("type": "array", "items": {{{}}})", item);
    text += least > 0 ? fmt::format(R"(, "minItems": {})", least) : "";
    return max > 0 ? text + fmt::format(R"(, "maxItems": {})", max) : text;
}

/// { from, to, count } or { from, to, step }.
std::string spread(const std::string& end, std::string_view third, const std::string& of_third) {
    return fmt::format(
        R"("type": "object", "properties": {{"from": {{{0}}}, "to": {{{0}}}, "{1}": {{{2}}}}}, )"
        R"("required": ["from", "to", "{1}"], "additionalProperties": false)",
        end, third, of_third);
}

constexpr const char* kName = R"("^[a-z0-9_]{1,64}$")";
constexpr const char* kLine = R"("^[^\\u0000-\\u001f\\u007f]{1,200}$")";
constexpr const char* kLines =
    R"("^(?=[\\s\\S]*[^ \\n])([^\\u0000-\\u001f\\u007f]*\\n){0,7}[^\\u0000-\\u001f\\u007f]*$")";
static_assert(kMaxInstructionLines == 8, "what kLines counts");

/// The schema of what a slot takes, without its braces.
struct ValueSchema {
    const Key& key;
    std::string number = protocols::number(key.range);

    std::string operator()(const Whole&) const { return protocols::number(key.range, "integer"); }
    std::string operator()(const OneOf& choice) const {
        return R"("enum": )" + json_words({choice.words.begin(), choice.words.end()});
    }
    std::string operator()(const bool*) const { return R"("type": "boolean")"; }
    std::string operator()(const std::string*) const {
        std::string text = R"("type": "string")";
        if (key.form == Form::name || key.form == Form::free) {
            text += fmt::format(R"(, "pattern": {})", key.form == Form::name ? kName : kLine);
        } else if (key.form == Form::lines) {
            text += fmt::format(R"(, "maxLength": {}, "pattern": {})", kMaxInstruction, kLines);
        }
        return text;
    }
    std::string operator()(const std::vector<double>*) const {
        const std::string list = list_of(number, key.form == Form::axis ? 1 : 0);
        if (key.form == Form::one_or_more) {
            return fmt::format(R"("anyOf": [{{{}}}, {{{}}}])", number, list);
        }
        return key.form != Form::axis
                 ? list
                 : fmt::format(R"("anyOf": [{{{}}}, {{{}}}, {{{}}}, {{{}}}])", number, list,
                               spread(number, "count", protocols::number({.min = 1.0}, "integer")),
                               spread(number, "step", protocols::number(kPositive)));
    }
    std::string operator()(const std::vector<std::string>*) const {
        return list_of(fmt::format(R"("type": "string", "pattern": {})", kName));
    }
    std::string operator()(const PointList*) const {
        const std::string point = list_of(number, 2, 3);
        return key.form == Form::point ? point : list_of(point);
    }
    std::string operator()(const PointGrid*) const {
        return list_of(list_of(list_of(number, 3, 3)));
    }
    std::string operator()(const NumberGrid*) const {
        return list_of(list_of(protocols::number({})));
    }
    /// A number, or a point in the plane; or none.
    template <class Value>
    std::string operator()(const Value*) const {
        constexpr bool is_number =
            std::is_same_v<Value, double> || std::is_same_v<Value, std::optional<double>>;
        return is_number ? number : list_of(number, 2, 2);
    }
};

/// JSON of what the key is if it is left out; "" for none.
std::string begun_json(const Key& key) {
    const Slot begun = key.slot(nullptr);
    const auto* whole = std::get_if<Whole>(&begun);
    const auto number = whole == nullptr ? std::nullopt : whole->get(whole->at);
    if ((key.need != Need::optional) || (number && !key.range.has(static_cast<double>(*number)))) {
        return {};
    }
    const std::string line = toml_lines({&key, 1}, nullptr);
    if (line.empty()) {
        return {};
    }
    const std::size_t begin = key.name.size() + 3;  // behind " = "
    const std::string text = line.substr(begin, line.size() - begin - 1);
    return text == "\"\"" ? std::string() : text;
}

/// Range and meaning: an editor shows them beside the key.
std::string description_of(const Key& key) {
    const Slot slot = key.slot(nullptr);
    const bool shows_itself =
        std::holds_alternative<OneOf>(slot) || std::holds_alternative<bool*>(slot);
    const std::string meaning = meaning_of(key);
    return shows_itself ? meaning : fmt::format("{} ({})", meaning, range_of(key));
}

}  // namespace

std::string json_words(const Names& words) {
    std::vector<std::string> texts;
    for (const std::string_view word : words) {
        texts.push_back(in_quotes(word));
    }
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string json_when(std::string_view condition,
                      std::string_view then,
                      std::string_view otherwise) {
    return fmt::format(R"({{"if": {}, "then": {}, "else": {}}})", condition, then, otherwise);
}

std::string both(std::string_view one, std::string_view other) {
    return fmt::format(R"({{"allOf": [{}, {}]}})", one, other);
}

std::string json_list(std::string_view item, std::size_t least, std::size_t max) {
    return fmt::format("{{{}}}", list_of(item.substr(1, item.size() - 2), least, max));
}

std::string needs(const Names& needed, const Names& refused) {
    std::string none;
    for (const std::string_view key : refused) {
        none += fmt::format(R"({}"{}": false)", none.empty() ? "" : ", ", key);
    }
    return fmt::format(R"({{"required": {}, "properties": {{{}}}}})", json_words(needed), none);
}

std::string where_given(std::string_view key, std::string_view is_such) {
    return fmt::format(R"({{"properties": {{"{}": {}}}}})", key, is_such);
}

std::string says(std::string_view key, const Names& words, bool or_none) {
    const std::string given = where_given(key, fmt::format(R"({{"enum": {}}})", json_words(words)));
    return or_none ? given : both(given, needs({key}));
}

Names names_of(Keys keys) {
    Names names;
    for (const Key& key : keys) {
        names.push_back(key.name);
    }
    return names;
}

Names required_of(Keys keys) {
    Names names;
    for (const Key& key : keys) {
        if (key.need == Need::required) {
            names.push_back(key.name);
        }
    }
    return names;
}

TableSchema::Property& TableSchema::property(std::string_view name) {
    const auto found = std::ranges::find(properties_, name, &Property::name);
    return found != properties_.end()
             ? *found
             : properties_.emplace_back(Property{.name = std::string(name)});
}

TableSchema& TableSchema::add(Keys keys, bool complete) {
    for (const Key& key : keys) {
        Property& one = property(key.name);
        const std::string begun = begun_json(key);
        one.type = std::visit(ValueSchema{key}, key.slot(nullptr));
        one.about = begun.empty() ? "" : fmt::format(R"(, "default": {})", begun);
        one.about += fmt::format(R"(, "description": {})", in_quotes(description_of(key)));
    }
    const Names needed = complete ? required_of(keys) : Names();
    required_.insert(required_.end(), needed.begin(), needed.end());
    return *this;
}

TableSchema& TableSchema::put(std::string_view name, std::string schema, bool required) {
    property(name).whole = std::move(schema);
    if (required) {
        required_.push_back(name);
    }
    return *this;
}

TableSchema& TableSchema::among(std::string_view name, const Names& words) {
    property(name).type = R"("enum": )" + json_words(words);
    return *this;
}

TableSchema& TableSchema::rule(std::string schema) {
    rules_.push_back(std::move(schema));
    return *this;
}

std::string TableSchema::text(std::string_view first) const {
    std::string properties;
    for (const Property& one : properties_) {
        properties += fmt::format("{}\n{}: {}", properties.empty() ? "" : ",", in_quotes(one.name),
                                  one.whole.empty() ? "{" + one.type + one.about + "}" : one.whole);
    }
    return fmt::format(R"({{{}"type": "object", "properties": {{{}}}, "required": {}, )"
                       R"("additionalProperties": false, "allOf": [{}]}})",
                       first, properties, json_words(required_),
                       rules_.empty() ? "true" : fmt::format("{}", fmt::join(rules_, ", ")));
}

}  // namespace palpate::protocols
