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

std::string json_array(const std::vector<std::string>& items) {
    return fmt::format("[{}]", fmt::join(items, ", "));
}

Members number_members(const Range& range, std::string_view type = "number") {
    Members members{{"type", in_quotes(type)}};
    if (std::isfinite(range.min)) {
        members.emplace_back(range.above ? "exclusiveMinimum" : "minimum",
                             fmt::format("{}", range.min));
    }
    if (std::isfinite(range.max)) {
        members.emplace_back("maximum", fmt::format("{}", range.max));
    }
    return members;
}

Members list_of(const Members& item, std::size_t least = 0, std::size_t most = 0) {
    Members members{{"type", in_quotes("array")}, {"items", json_object(item)}};
    if (least > 0) {
        members.emplace_back("minItems", std::to_string(least));
    }
    if (most > 0) {
        members.emplace_back("maxItems", std::to_string(most));
    }
    return members;
}

Members any_of(const std::vector<Members>& all) {
    std::vector<std::string> texts;
    for (const Members& one : all) {
        texts.push_back(json_object(one));
    }
    return {{"anyOf", json_array(texts)}};
}

/// { from, to, count } or { from, to, step }.
Members spread(const Range& range, std::string_view third, const Members& of_third) {
    const std::string end = json_object(number_members(range));
    return {
        {"type", in_quotes("object")},
        {"properties",
         json_object({{"from", end}, {"to", end}, {std::string(third), json_object(of_third)}})},
        {"required", json_words({"from", "to", third})},
        {"additionalProperties", "false"}};
}

constexpr const char* kName = R"("^[a-z0-9_]{1,64}$")";
constexpr const char* kLine = R"("^[^\\u0000-\\u001f\\u007f]{1,200}$")";
constexpr const char* kLines =
    R"("^(?=[\\s\\S]*[^ \\n])([^\\u0000-\\u001f\\u007f]*\\n){0,7}[^\\u0000-\\u001f\\u007f]*$")";
static_assert(kMaxInstructionLines == 8, "what kLines counts");

/// The schema of what a slot takes.
struct ValueSchema {
    const Key& key;

    Members operator()(const double*) const { return number_members(key.range); }
    Members operator()(const std::optional<double>*) const { return number_members(key.range); }
    Members operator()(const Whole&) const { return number_members(key.range, "integer"); }
    Members operator()(const OneOf& choice) const {
        return {{"enum", json_words({choice.words.begin(), choice.words.end()})}};
    }
    Members operator()(const bool*) const { return {{"type", in_quotes("boolean")}}; }
    Members operator()(const std::string*) const {
        Members members{{"type", in_quotes("string")}};
        if (key.form == Form::name || key.form == Form::free) {
            members.emplace_back("pattern", key.form == Form::name ? kName : kLine);
        } else if (key.form == Form::lines) {
            members.emplace_back("maxLength", std::to_string(kMaxInstruction));
            members.emplace_back("pattern", kLines);
        }
        return members;
    }
    Members operator()(const engine::Vec2*) const {
        return list_of(number_members(key.range), 2, 2);
    }
    Members operator()(const std::optional<engine::Vec2>*) const {
        return list_of(number_members(key.range), 2, 2);
    }
    Members operator()(const std::vector<double>*) const {
        const Members one = number_members(key.range);
        switch (key.form) {
            case Form::one_or_more:
                return any_of({one, list_of(one)});
            case Form::axis:
                return any_of({one, list_of(one, 1),
                               spread(key.range, "count", number_members({.min = 1.0}, "integer")),
                               spread(key.range, "step", number_members(kPositive))});
            default:
                return list_of(one);
        }
    }
    Members operator()(const std::vector<std::string>*) const {
        return list_of({{"type", in_quotes("string")}, {"pattern", kName}});
    }
    Members operator()(const PointList*) const {
        const Members point = list_of(number_members(key.range), 2, 3);
        return key.form == Form::point ? point : list_of(point);
    }
    Members operator()(const PointGrid*) const {
        return list_of(list_of(list_of(number_members(key.range), 3, 3)));
    }
    Members operator()(const NumberGrid*) const { return list_of(list_of(number_members({}))); }
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

/// Links lead nowhere in an editor.
std::string without_links(std::string text) {
    for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at)) {
        text.erase(at, text.find(')', at) - at + 1);
        text.erase(text.rfind('[', at), 1);
    }
    return text;
}

/// Range and meaning: an editor shows them beside the key.
std::string description_of(const Key& key) {
    const Slot slot = key.slot(nullptr);
    const bool shows_itself =
        std::holds_alternative<OneOf>(slot) || std::holds_alternative<bool*>(slot);
    const std::string meaning = without_links(std::string(key.meaning));
    return shows_itself ? meaning : fmt::format("{} ({})", meaning, range_of(key));
}

}  // namespace

std::string json_object(const Members& members) {
    std::string text = "{";
    for (const auto& [name, value] : members) {
        text += fmt::format("{}{}: {}", text.size() > 1 ? ", " : "", in_quotes(name), value);
    }
    return text + "}";
}

std::string json_words(const std::vector<std::string_view>& words) {
    std::vector<std::string> texts;
    for (const std::string_view word : words) {
        texts.push_back(in_quotes(word));
    }
    return json_array(texts);
}

std::string json_when(const std::string& condition,
                      const std::string& then,
                      const std::string& otherwise) {
    Members members{{"if", condition}};
    if (!then.empty()) {
        members.emplace_back("then", then);
    }
    if (!otherwise.empty()) {
        members.emplace_back("else", otherwise);
    }
    return json_object(members);
}

std::string json_list(const std::string& item, std::size_t least, std::size_t most) {
    Members members{{"type", in_quotes("array")}, {"items", item}};
    members.emplace_back("minItems", std::to_string(least));
    if (most > 0) {
        members.emplace_back("maxItems", std::to_string(most));
    }
    return json_object(members);
}

std::string needs_all(const std::vector<std::string_view>& keys) {
    return needs_and_lacks(keys, {});
}

std::string has_none(const std::vector<std::string_view>& keys) {
    return needs_and_lacks({}, keys);
}

std::string needs_and_lacks(const std::vector<std::string_view>& needed,
                            const std::vector<std::string_view>& refused) {
    Members none;
    for (const std::string_view key : refused) {
        none.emplace_back(key, "false");
    }
    Members members;
    if (!needed.empty()) {
        members.emplace_back("required", json_words(needed));
    }
    if (!none.empty()) {
        members.emplace_back("properties", json_object(none));
    }
    return json_object(members);
}

std::string says(std::string_view key, const std::vector<std::string_view>& words, bool or_none) {
    Members members{{"properties", json_object({{std::string(key),
                                                 json_object({{"enum", json_words(words)}})}})}};
    if (!or_none) {
        members.emplace_back("required", json_words({key}));
    }
    return json_object(members);
}

std::vector<std::string_view> names_of(Keys keys) {
    std::vector<std::string_view> names;
    for (const Key& key : keys) {
        names.push_back(key.name);
    }
    return names;
}

std::vector<std::string_view> required_of(Keys keys) {
    std::vector<std::string_view> names;
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
        Members& schema = property(key.name).schema;
        schema = std::visit(ValueSchema{key}, key.slot(nullptr));
        if (const std::string begun = begun_json(key); !begun.empty()) {
            schema.emplace_back("default", begun);
        }
        schema.emplace_back("description", in_quotes(description_of(key)));
    }
    const auto needed = complete ? required_of(keys) : std::vector<std::string_view>();
    required_.insert(required_.end(), needed.begin(), needed.end());
    return *this;
}

TableSchema& TableSchema::put(std::string_view name, std::string schema, bool required) {
    Property& one = property(name);
    one.whole = std::move(schema);
    if (required) {
        required_.push_back(name);
    }
    return *this;
}

TableSchema& TableSchema::among(std::string_view name, const std::vector<std::string_view>& words) {
    std::erase_if(property(name).schema, [](const auto& member) {
        return member.first == "type" || member.first == "pattern";
    });
    Members& schema = property(name).schema;
    schema.insert(schema.begin(), {"enum", json_words(words)});
    return *this;
}

TableSchema& TableSchema::rule(std::string schema) {
    rules_.push_back(std::move(schema));
    return *this;
}

std::string TableSchema::text(const Members& first) const {
    std::string properties;
    for (const Property& one : properties_) {
        properties += fmt::format("{}\n{}: {}", properties.empty() ? "" : ",", in_quotes(one.name),
                                  one.whole.empty() ? json_object(one.schema) : one.whole);
    }
    Members members = first;
    members.emplace_back("type", in_quotes("object"));
    members.emplace_back("properties", "{" + properties + "}");
    if (!required_.empty()) {
        members.emplace_back("required", json_words(required_));
    }
    members.emplace_back("additionalProperties", "false");
    if (!rules_.empty()) {
        members.emplace_back("allOf", json_array(rules_));
    }
    return json_object(members);
}

}  // namespace palpate::protocols
