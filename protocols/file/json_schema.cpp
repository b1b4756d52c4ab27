#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/refuse.hpp"
#include "protocols/file/calibration_keys.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/object_tables.hpp"
#include "protocols/file/observer_file.hpp"
#include "protocols/file/procedure_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/scene_file.hpp"
#include "protocols/file/table_schema.hpp"

namespace palpate::protocols {
namespace {

template <class Record>
Json table_of() {
    return table_schema(keys_of<Record>());
}

/// Those of `all` that are not among `some`.
Names without(const Names& all, const Names& some) {
    Names rest;
    for (const std::string_view one : all) {
        if (std::ranges::find(some, one) == some.end()) {
            rest.push_back(one);
        }
    }
    return rest;
}

void put_format(Json& file, std::int64_t format) {
    put(file, "format", {{"const", format}, {"description", "the version of the format"}}, true);
}

Json segment_schema(Keys keys) {
    Json segment = table_schema(keys.first(1));
    add(segment, keys.subspan(1), false);
    const Names all = names_of(keys.subspan(1));
    using enum stimuli::Segment::Kind;
    for (const auto kind : {nurbs, line, arc}) {
        const Keys own = keys_of_segment(kind);
        rule(segment, json_when(says("kind", {word_of(kind)}),
                                needs(required_of(own), without(all, names_of(own)))));
    }
    return segment;
}

/// One object by itself, of two curves or of segments; or a set of several.
Json object_schema() {
    const auto tables = object_reference();
    const Keys set = tables.at(0).keys;
    const Keys ladder = tables.at(1).keys;
    Json object = table_schema();
    for (const Keys keys : {keys_of<ObjectSpec>(), set, ladder}) {
        add(object, keys, false);
    }
    put(object, "segment", json_list(segment_schema(tables.at(2).keys), 1, kMaxSegments));
    Names of_sets = names_of(set);
    const Names of_ladders = names_of(ladder);
    of_sets.insert(of_sets.end(), of_ladders.begin(), of_ladders.end());
    rule(object,
         json_when(
             needs({"set"}),
             both(needs({}, {"name", "curvature_per_m", "segment"}),
                  json_when(says("set", {"curvature_ladder"}), needs(of_ladders),
                            needs({}, of_ladders))),
             both(needs(required_of(keys_of<ObjectSpec>()), of_sets),
                  {{"oneOf", Json::array({needs({"curvature_per_m"}), needs({"segment"})})}})));
    return object;
}

/// Each law with the keys that it needs, without those that it does not read.
/// @param as_gos   more words, that read what gos reads
/// @param or_none  no law is gos
Json friction_schema(Keys keys, const Names& as_gos = {}, bool or_none = false) {
    Json friction = table_schema(keys);
    Names laws = as_gos;
    for (const LawKeys& law : friction_laws()) {
        laws.push_back(law.law);
        Names needed;
        Names refused;
        for (const Key& key : keys) {
            if (law.needs(key.name)) {
                needed.push_back(key.name);
            } else if (!law.reads(key)) {
                refused.push_back(key.name);
            }
        }
        Names words{law.law};
        if (law.relaxes) {
            words.insert(words.end(), as_gos.begin(), as_gos.end());
        }
        rule(friction,
             json_when(says("law", words, or_none && law.relaxes), needs(needed, refused)));
    }
    among(friction, "law", laws);
    return friction;
}

/// Of each parameter weights, or a normal prior.
Json prior_schema() {
    const Json normal = {
        {"type", "object"},
        {"properties",
         {{"mean", {{"type", "number"}}}, {"sd", {{"type", "number"}, {"exclusiveMinimum", 0}}}}},
        {"required", Json::array({"mean", "sd"})},
        {"additionalProperties", false}};
    const Json weights = json_list({{"type", "number"}, {"minimum", 0}});
    Json prior = table_schema();
    for (const Key& key : procedure_keys("prior")) {
        put(prior, key.name,
            {{"anyOf", Json::array({weights, normal})},
             {"description", "a weight for each value, or mean and sd of a normal prior"}});
    }
    return prior;
}

Json model_schema() {
    const Keys keys = procedure_keys("model");
    Json model = table_schema();
    add(model, keys, false);
    const Keys function = keys.subspan(1, keys.size() - 2);
    const Keys items = keys.last(1);
    rule(model, json_when(says("kind", {word_of(ModelKind::identification)}),
                          needs(required_of(items), names_of(function)),
                          needs(required_of(function), names_of(items))));
    return model;
}

/// The tables of a rule, put beside its keys: in a file [procedure] has the keys alone.
void put_rule_tables(Json& to) {
    for (const char* name : {"constant", "quest", "stimuli", "parameters"}) {
        put(to, name, table_schema(procedure_keys(name)));
    }
    put(to, "staircase", json_list(table_schema(procedure_keys("staircase")), 1));
    put(to, "model", model_schema());
    put(to, "prior", prior_schema());
    put(to, "stream", table_schema(procedure_keys("stream")));
}

/// What follows from the kind of a rule. @param where  wraps the schema of the table with `kind`
template <class Where>
void add_rule_kinds(Json& to, const Where& where) {
    Names all_tables;
    for (const RuleKind kind :
         {RuleKind::constant, RuleKind::staircase, RuleKind::quest, RuleKind::quest_plus}) {
        const Names own = tables_of_rule(kind);
        all_tables.insert(all_tables.end(), own.begin(), own.end());
    }
    const Names all_keys = names_of(procedure_keys("procedure").subspan(1));
    for (std::size_t i = 0; i < kWordsOf<RuleKind>.size(); ++i) {
        const auto kind = static_cast<RuleKind>(i);
        const Names own = tables_of_rule(kind);
        const Names needed = without(own, {"prior"});
        const Names other_keys = without(all_keys, names_of(keys_of_rule(kind)));
        rule(to, json_when(
                     where(says("kind", {kWordsOf<RuleKind>.at(i)})),
                     both(where(needs({}, other_keys)), needs(needed, without(all_tables, own)))));
    }
}

Json adaptive_schema() {
    Json procedure = table_schema(keys_of<AdaptiveSpec>());
    add(procedure, procedure_keys("procedure"));
    put_rule_tables(procedure);
    add_rule_kinds(procedure, std::identity());
    return procedure;
}

Json instructions_schema() {
    Json languages = table_schema();
    for (const std::string_view language : kLanguages) {
        put(languages, language, table_of<InstructionTexts>());
    }
    return languages;
}

/// [design] alone, or [procedure] with [[run]] and the breaks of [design].
Json design_or_procedure() {
    const Keys design = keys_of<DesignSpec>();
    Names needed;
    for (const Key& key : design) {
        if (key.need == Need::factorial) {
            needed.push_back(key.name);
        }
    }
    return json_when(
        needs({"procedure"}),
        both(needs({"run"}),
             where_given("design", needs({}, without(names_of(design), {"break_every"})))),
        both(needs({"design"}, {"run"}), where_given("design", needs(needed))));
}

Json protocol_schema() {
    Json file = table_schema();
    put_format(file, kFormat);
    put(file, "study", table_of<Protocol>(), true);
    put(file, "apparatus", table_of<ApparatusSpec>());
    put(file, "outline", table_of<OutlineSpec>());
    put(file, "surface", table_of<SurfaceSpec>());
    put(file, "object", json_list(object_schema(), 1, kMaxObjects), true);
    put(file, "friction", json_list(friction_schema(keys_of<FrictionSpec>()), 1, kMaxFrictions),
        true);
    put(file, "safety", table_of<SafetySpec>());
    put(file, "invalid", table_of<InvalidSpec>());
    put(file, "exclusion", table_of<ExclusionSpec>());
    put(file, "analysis", table_of<AnalysisSpec>());
    put(file, "design", table_of<DesignSpec>());
    put(file, "timing", table_of<TimingSpec>());
    put(file, "response", table_of<ResponseSpec>());
    put(file, "procedure", adaptive_schema());
    put(file, "run", json_list(table_of<RunSpec>(), 1, kMaxRuns));
    put(file, "observer", table_of<ObserverSpec>());
    put(file, "masking", table_of<MaskingSpec>());
    put(file, "instructions", instructions_schema());
    rule(file, design_or_procedure());
    return file;
}

Json procedure_schema() {
    Json file = table_schema();
    put_format(file, kProcedureFormat);
    put(file, "procedure", table_schema(procedure_keys("procedure")), true);
    put_rule_tables(file);
    add_rule_kinds(file, [](const Json& schema) { return where_given("procedure", schema); });
    return file;
}

Json scene_schema() {
    const auto tables = scene_reference();
    const auto keys = [&](std::size_t i) {
        return tables.at(i).keys;
    };
    Json renderer = table_schema(keys(0));
    add(renderer, keys(1), false);
    rule(renderer, json_when(says("tracker", {"feedback", "feed_forward", "feedback_linearised"}),
                             needs({"gain"}), needs({}, {"gain"})));
    Json file = table_schema();
    put(file, "renderer", renderer);
    put(file, "friction",
        friction_schema(keys(2), Names(kThesisLaws.begin(), kThesisLaws.end()), true));
    put(file, "segment", json_list(segment_schema(keys(3))));
    put(file, "surface", json_list(table_schema(keys(4))));
    rule(file, {{"anyOf", Json::array({needs({"segment"}), needs({"surface"})})}});
    return file;
}

Json machine_schema(bool gantry) {
    const auto tables = machine_tables(gantry);
    Json machine = table_schema(tables.front().keys);
    for (const MachineTable& part : tables.subspan(1)) {
        put(machine, part.name, table_schema(part.keys), part.required);
    }
    return machine;
}

Json calibration_schema() {
    Json record = table_schema(kRecordKeys.any);
    add(record, kRecordKeys.linkage, false);
    const Names axes{"axis_x", "axis_y", "axis_z"};
    for (const std::string_view axis : axes) {
        put(record, axis, table_schema(kRecordKeys.axis));
    }
    rule(record, json_when(needs({"axis_x"}), needs(axes, names_of(kRecordKeys.linkage)),
                           needs(required_of(kRecordKeys.linkage), axes)));
    Json file = table_schema();
    put_format(file, 1);
    put(file, "pantograph", json_list(machine_schema(false)));
    put(file, "gantry", json_list(machine_schema(true)));
    put(file, "commissioning", record);
    rule(file, {{"anyOf", Json::array({needs({"pantograph"}), needs({"gantry"})})}});
    return file;
}

Json observer_schema() {
    Json file = table_schema();
    put_format(file, 1);
    for (const TableText& table : observer_reference()) {
        put(file, std::string_view(table.heading).substr(1, table.heading.size() - 2),
            table_schema(table.keys));
    }
    return file;
}

}  // namespace

std::string json_schema(std::string_view kind) {
    using Make = Json (*)();
    constexpr std::array<Make, kSchemaKinds.size()> kMakers{
        protocol_schema, procedure_schema, scene_schema, calibration_schema, observer_schema};
    const auto found = std::ranges::find(kSchemaKinds, kind);
    refuse_if(found == kSchemaKinds.end(), "there is no schema of {}: give one of {}", kind,
              fmt::join(kSchemaKinds, ", "));
    Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                   {"title", fmt::format("palpate: {}", kind)}};
    schema.update(kMakers.at(static_cast<std::size_t>(found - kSchemaKinds.begin()))());
    return schema.dump(1) + "\n";
}

}  // namespace palpate::protocols
