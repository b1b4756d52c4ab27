#include "protocols/file/table_schema.hpp"

#include <cmath>
#include <ranges>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace palpate::protocols {
namespace {

Json number_in(const Range& range, std::string_view type = "number") {
    Json schema = {{"type", type}};
    if (std::isfinite(range.min)) {
        schema[range.above ? "exclusiveMinimum" : "minimum"] = range.min;
    }
    if (std::isfinite(range.max)) {
        schema[range.below ? "exclusiveMaximum" : "maximum"] = range.max;
    }
    return schema;
}

/// { from, to, count } or { from, to, step }.
Json spread(const Json& end, std::string_view third, const Json& of_third) {
    return {{"type", "object"},
            {"properties", {{"from", end}, {"to", end}, {third, of_third}}},
            {"required", {"from", "to", third}},
            {"additionalProperties", false}};
}

constexpr const char* kName = "^[a-z0-9_]{1,64}$";
constexpr const char* kLine = R"(^[^\u0000-\u001f\u007f]{1,200}$)";
constexpr const char* kLines =
    R"(^(?=[\s\S]*[^ \n])([^\u0000-\u001f\u007f]*\n){0,7}[^\u0000-\u001f\u007f]*$)";
static_assert(kMaxInstructionLines == 8, "what kLines counts");

/// The schema of what a slot takes.
struct ValueSchema {
    const Key& key;
    Json number = number_in(key.range);

    Json operator()(const Whole&) const { return number_in(key.range, "integer"); }
    Json operator()(const OneOf& choice) const {
        return {{"enum", Names(choice.words.begin(), choice.words.end())}};
    }
    Json operator()(const bool*) const { return {{"type", "boolean"}}; }
    Json operator()(const std::string*) const {
        Json text = {{"type", "string"}};
        if (key.form == Form::lines) {
            text["maxLength"] = kMaxInstruction;
        }
        if (key.form != Form::any) {
            text["pattern"] = key.form == Form::name ? kName
                            : key.form == Form::free ? kLine
                                                     : kLines;
        }
        return text;
    }
    Json operator()(const std::vector<double>*) const {
        Json list = json_list(number, key.form == Form::axis ? 1 : 0);
        if (key.form == Form::one_or_more) {
            return {{"anyOf", Json::array({number, std::move(list)})}};
        }
        if (key.form != Form::axis) {
            return list;
        }
        return {{"anyOf", Json::array({number, std::move(list),
                                       spread(number, "count", number_in({.min = 1.0}, "integer")),
                                       spread(number, "step", number_in(kPositive))})}};
    }
    Json operator()(const std::vector<std::string>*) const {
        return json_list({{"type", "string"}, {"pattern", kName}});
    }
    Json operator()(const PointList*) const {
        Json point = json_list(number, 2, 3);
        return key.form == Form::point ? point : json_list(std::move(point));
    }
    Json operator()(const PointGrid*) const {
        return json_list(json_list(json_list(number, 3, 3)));
    }
    Json operator()(const NumberGrid*) const { return json_list(json_list(number_in({}))); }
    /// A number, or a point in the plane; or none.
    template <class Value>
    Json operator()(const Value*) const {
        constexpr bool is_number =
            std::is_same_v<Value, double> || std::is_same_v<Value, std::optional<double>>;
        return is_number ? number : json_list(number, 2, 2);
    }
};

/// What the key is if it is left out; null for none.
Json begun_json(const Key& key) {
    const Slot begun = key.slot(nullptr);
    const auto* whole = std::get_if<Whole>(&begun);
    const auto number = whole == nullptr ? std::nullopt : whole->get(whole->at);
    if ((key.need != Need::optional) || (number && !key.range.has(static_cast<double>(*number)))) {
        return {};
    }
    const std::string line = toml_lines({&key, 1}, nullptr);  // a value of TOML is one of JSON here
    return line.empty() ? Json() : Json::parse(line.substr(line.find('=') + 1));
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

Json json_when(Json condition, Json then, Json otherwise) {
    return {
        {"if", std::move(condition)}, {"then", std::move(then)}, {"else", std::move(otherwise)}};
}

Json json_when(Json condition, Json then) {
    return json_when(std::move(condition), std::move(then), true);
}

Json both(Json one, Json other) {
    return {{"allOf", Json::array({std::move(one), std::move(other)})}};
}

Json json_list(Json item, std::size_t least, std::size_t max) {
    Json list = {{"type", "array"}, {"items", std::move(item)}};
    if (least > 0) {
        list["minItems"] = least;
    }
    if (max > 0) {
        list["maxItems"] = max;
    }
    return list;
}

Json needs(const Names& needed, const Names& refused) {
    Json none = Json::object();
    for (const std::string_view key : refused) {
        none[std::string(key)] = false;
    }
    return {{"required", needed}, {"properties", std::move(none)}};
}

Json where_given(std::string_view key, Json is_such) {
    return {{"properties", {{key, std::move(is_such)}}}};
}

Json says(std::string_view key, const Names& words, bool or_none) {
    Json given = where_given(key, {{"enum", words}});
    return or_none ? given : both(std::move(given), needs({key}));
}

Names names_of(Keys keys) {
    const auto names = std::views::transform(keys, &Key::name);
    return {names.begin(), names.end()};
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

Json table_schema(Keys keys) {
    Json table = {{"type", "object"},
                  {"properties", Json::object()},
                  {"required", Json::array()},
                  {"additionalProperties", false}};
    add(table, keys);
    return table;
}

void add(Json& table, Keys keys, bool complete) {
    for (const Key& key : keys) {
        Json schema = std::visit(ValueSchema{key}, key.slot(nullptr));
        if (Json begun = begun_json(key); !begun.is_null()) {
            schema["default"] = std::move(begun);
        }
        schema["description"] = description_of(key);
        put(table, key.name, std::move(schema), complete && key.need == Need::required);
    }
}

void put(Json& table, std::string_view name, Json schema, bool required) {
    table["properties"][std::string(name)] = std::move(schema);
    if (required) {
        table["required"].push_back(name);
    }
}

void among(Json& table, std::string_view name, const Names& words) {
    Json& text = table["properties"][std::string(name)];
    text.erase("type");
    text.erase("pattern");
    text["enum"] = words;
}

void rule(Json& table, Json schema) {
    table["allOf"].push_back(std::move(schema));
}

}  // namespace palpate::protocols
