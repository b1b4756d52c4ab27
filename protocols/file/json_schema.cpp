#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
std::string table_of() {
    return TableSchema(keys_of<Record>()).text();
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

void put_format(TableSchema& file, std::int64_t format) {
    file.put("format",
             fmt::format(R"({{"const": {}, "description": "the version of the format"}})", format),
             true);
}

std::string segment_schema(Keys keys) {
    TableSchema segment;
    segment.add(keys.first(1)).add(keys.subspan(1), false);
    const Names all = names_of(keys.subspan(1));
    using enum stimuli::Segment::Kind;
    for (const auto kind : {nurbs, line, arc}) {
        const Keys own = keys_of_segment(kind);
        segment.rule(json_when(says("kind", {word_of(kind)}),
                               needs(required_of(own), without(all, names_of(own)))));
    }
    return segment.text();
}

/// One object by itself, of two curves or of segments; or a set of several.
std::string object_schema() {
    const auto tables = object_reference();
    const Keys set = tables.at(0).keys;
    const Keys ladder = tables.at(1).keys;
    TableSchema object;
    object.add(keys_of<ObjectSpec>(), false).add(set, false).add(ladder, false);
    object.put("segment", json_list(segment_schema(tables.at(2).keys), 1, kMaxSegments));
    Names of_sets = names_of(set);
    const Names of_ladders = names_of(ladder);
    of_sets.insert(of_sets.end(), of_ladders.begin(), of_ladders.end());
    object.rule(json_when(needs({"set"}),
                          both(needs({}, {"name", "curvature_per_m", "segment"}),
                               json_when(says("set", {"curvature_ladder"}), needs(of_ladders),
                                         needs({}, of_ladders))),
                          both(needs(required_of(keys_of<ObjectSpec>()), of_sets),
                               fmt::format(R"({{"oneOf": [{}, {}]}})", needs({"curvature_per_m"}),
                                           needs({"segment"})))));
    return object.text();
}

/// Each law with the keys that it needs, without those that it does not read.
/// @param as_gos   more words, that read what gos reads
/// @param or_none  no law is gos
std::string friction_schema(Keys keys, const Names& as_gos = {}, bool or_none = false) {
    TableSchema friction(keys);
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
        friction.rule(
            json_when(says("law", words, or_none && law.relaxes), needs(needed, refused)));
    }
    return friction.among("law", laws).text();
}

/// Of each parameter weights, or a normal prior.
std::string prior_schema() {
    TableSchema prior;
    for (const Key& key : procedure_keys("prior")) {
        prior.put(key.name,
                  R"({"anyOf": [{"type": "array", "items": {"type": "number", "minimum": 0}}, )"
                  R"({"type": "object", "properties": {"mean": {"type": "number"}, "sd": )"
                  R"({"type": "number", "exclusiveMinimum": 0}}, "required": ["mean", "sd"], )"
                  R"("additionalProperties": false}], "description": )"
                  R"("a weight for each value, or mean and sd of a normal prior"})");
    }
    return prior.text();
}

std::string model_schema() {
    const Keys keys = procedure_keys("model");
    TableSchema model;
    model.add(keys, false);
    const Keys function = keys.subspan(1, keys.size() - 2);
    const Keys items = keys.last(1);
    return model
        .rule(json_when(says("kind", {word_of(ModelKind::identification)}),
                        needs(required_of(items), names_of(function)),
                        needs(required_of(function), names_of(items))))
        .text();
}

/// The tables of a rule, put beside its keys: in a file [procedure] has the keys alone.
void put_rule_tables(TableSchema& to) {
    for (const char* name : {"constant", "quest", "stimuli", "parameters"}) {
        to.put(name, TableSchema(procedure_keys(name)).text());
    }
    to.put("staircase", json_list(TableSchema(procedure_keys("staircase")).text(), 1));
    to.put("model", model_schema());
    to.put("prior", prior_schema());
    to.put("stream", TableSchema(procedure_keys("stream")).text());
}

/// What follows from the kind of a rule. @param where  wraps the schema of the table with `kind`
template <class Where>
void add_rule_kinds(TableSchema& to, const Where& where) {
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
        to.rule(
            json_when(where(says("kind", {kWordsOf<RuleKind>.at(i)})),
                      both(where(needs({}, other_keys)), needs(needed, without(all_tables, own)))));
    }
}

std::string adaptive_schema() {
    TableSchema procedure(keys_of<AdaptiveSpec>());
    procedure.add(procedure_keys("procedure"));
    put_rule_tables(procedure);
    add_rule_kinds(procedure, std::identity());
    return procedure.text();
}

std::string instructions_schema() {
    TableSchema languages;
    for (const std::string_view language : kLanguages) {
        languages.put(language, table_of<InstructionTexts>());
    }
    return languages.text();
}

/// [design] alone, or [procedure] with [[run]] and the breaks of [design].
std::string design_or_procedure() {
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

TableSchema protocol_schema() {
    TableSchema file;
    put_format(file, kFormat);
    file.put("study", table_of<Protocol>(), true)
        .put("apparatus", table_of<ApparatusSpec>())
        .put("outline", table_of<OutlineSpec>())
        .put("surface", table_of<SurfaceSpec>())
        .put("object", json_list(object_schema(), 1, kMaxObjects), true)
        .put("friction", json_list(friction_schema(keys_of<FrictionSpec>()), 1, kMaxFrictions),
             true)
        .put("safety", table_of<SafetySpec>())
        .put("invalid", table_of<InvalidSpec>())
        .put("exclusion", table_of<ExclusionSpec>())
        .put("analysis", table_of<AnalysisSpec>())
        .put("design", table_of<DesignSpec>())
        .put("timing", table_of<TimingSpec>())
        .put("response", table_of<ResponseSpec>())
        .put("procedure", adaptive_schema())
        .put("run", json_list(table_of<RunSpec>(), 1, kMaxRuns))
        .put("observer", table_of<ObserverSpec>())
        .put("masking", table_of<MaskingSpec>())
        .put("instructions", instructions_schema())
        .rule(design_or_procedure());
    return file;
}

TableSchema procedure_schema() {
    TableSchema file;
    put_format(file, kProcedureFormat);
    file.put("procedure", TableSchema(procedure_keys("procedure")).text(), true);
    put_rule_tables(file);
    add_rule_kinds(file,
                   [](const std::string& schema) { return where_given("procedure", schema); });
    return file;
}

TableSchema scene_schema() {
    const auto tables = scene_reference();
    const auto keys = [&](std::size_t i) {
        return tables.at(i).keys;
    };
    TableSchema renderer(keys(0));
    renderer.add(keys(1), false)
        .rule(json_when(says("tracker", {"feedback", "feed_forward", "feedback_linearised"}),
                        needs({"gain"}), needs({}, {"gain"})));
    TableSchema file;
    file.put("renderer", renderer.text())
        .put("friction",
             friction_schema(keys(2), Names(kThesisLaws.begin(), kThesisLaws.end()), true))
        .put("segment", json_list(segment_schema(keys(3))))
        .put("surface", json_list(TableSchema(keys(4)).text()))
        .rule(fmt::format(R"({{"anyOf": [{}, {}]}})", needs({"segment"}), needs({"surface"})));
    return file;
}

std::string machine_schema(bool gantry) {
    const auto tables = machine_tables(gantry);
    TableSchema machine(tables.front().keys);
    for (const MachineTable& part : tables.subspan(1)) {
        machine.put(part.name, TableSchema(part.keys).text(), part.required);
    }
    return machine.text();
}

TableSchema calibration_schema() {
    TableSchema record(kRecordKeys.any);
    record.add(kRecordKeys.linkage, false);
    const Names axes{"axis_x", "axis_y", "axis_z"};
    for (const std::string_view axis : axes) {
        record.put(axis, TableSchema(kRecordKeys.axis).text());
    }
    record.rule(json_when(needs({"axis_x"}), needs(axes, names_of(kRecordKeys.linkage)),
                          needs(required_of(kRecordKeys.linkage), axes)));
    TableSchema file;
    put_format(file, 1);
    file.put("pantograph", json_list(machine_schema(false)))
        .put("gantry", json_list(machine_schema(true)))
        .put("commissioning", record.text())
        .rule(fmt::format(R"({{"anyOf": [{}, {}]}})", needs({"pantograph"}), needs({"gantry"})));
    return file;
}

TableSchema observer_schema() {
    TableSchema file;
    put_format(file, 1);
    for (const TableText& table : observer_reference()) {
        file.put(std::string_view(table.heading).substr(1, table.heading.size() - 2),
                 TableSchema(table.keys).text());
    }
    return file;
}

}  // namespace

std::string json_schema(std::string_view kind) {
    using Make = TableSchema (*)();
    constexpr std::array<Make, kSchemaKinds.size()> kMakers{
        protocol_schema, procedure_schema, scene_schema, calibration_schema, observer_schema};
    const auto found = std::ranges::find(kSchemaKinds, kind);
    refuse_if(found == kSchemaKinds.end(), "there is no schema of {}: give one of {}", kind,
              fmt::join(kSchemaKinds, ", "));
    const TableSchema schema = kMakers.at(static_cast<std::size_t>(found - kSchemaKinds.begin()))();
    return schema.text(fmt::format(R"("$schema": "https://json-schema.org/draft/2020-12/schema", )"
                                   R"("title": "palpate: {}", )",
                                   kind)) +
           "\n";
}

}  // namespace palpate::protocols
