#include "protocols/file/procedure_file.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/file/document.hpp"
#include "protocols/psychometric/exact_math.hpp"

namespace palpate::protocols {
namespace {

struct NormalPrior {
    double mean = 0.0;
    double sd = 1.0;
};
// clang-format off
constexpr Key kNormalPrior[]{
    {.name = "mean", .slot = at<&NormalPrior::mean>, .need = Need::required, .meaning = "of the normal prior"},
    {.name = "sd", .slot = at<&NormalPrior::sd>, .need = Need::required, .range = {.min = 0.0, .above = true}, .meaning = "its standard deviation"},
};
constexpr Key kWeights{.name = "", .slot = [](void* r) -> Slot { return static_cast<std::vector<double>*>(r); }, .range = {.min = 0.0}, .meaning = ""};
// clang-format on

class FileReader {
public:
    FileReader(const Table& file, Problems& problems, Places& places)
        : file_(file), problems_(problems), top_(file, "", {}, problems, places, "the file") {}

    Procedure read(std::string_view file_name) {
        top_.check_format(kProcedureFormat);
        problems_.throw_if_any(file_name);
        std::optional<ProcedureSpec> spec = read_rule();
        const Pcg32 random = read_stream();
        problems_.throw_if_any(file_name);
        std::optional<Procedure> ready;
        attempt([&] { ready.emplace(*spec, random); });
        problems_.throw_if_any(file_name);
        return std::move(ready.value());
    }

    /// The rule, tried once.
    std::optional<ProcedureSpec> rule() {
        std::optional<ProcedureSpec> spec = read_rule();
        if (spec && problems_.none()) {
            attempt([&] { static_cast<void>(Procedure(*spec, Pcg32(0, 0))); });
        }
        return problems_.none() ? std::move(spec) : std::nullopt;
    }

private:
    template <class Make>
    void attempt(Make&& make) {
        try {
            make();
        } catch (const std::invalid_argument& e) {
            Position at = main_;
            for (const Entry& entry : file_) {
                const auto* table = std::get_if<Table>(&entry.value.data);
                if (table != nullptr && entry.key != "prior") {  // it has names of [parameters]
                    at = spoken_of(*table, e.what(), at);
                }
            }
            problems_.add(at, e.what());
        }
    }

    std::optional<ProcedureSpec> read_rule() {
        TableReader procedure = section("procedure");
        const Keys keys = procedure_keys("procedure");
        procedure.read(keys.first(1), &rule_);
        if (procedure.broken()) {  // all else depends on the kind
            return std::nullopt;
        }
        procedure.read_last(keys_of_rule(rule_.kind), &rule_);
        check_tables();
        switch (rule_.kind) {
            case RuleKind::constant:
                return filled<ConstantStimuliSpec>("constant");
            case RuleKind::staircase:
                return read_staircases();
            case RuleKind::quest: {
                QuestSpec spec = filled<QuestSpec>("quest");
                spec.trials = rule_.trials;
                return spec;
            }
            case RuleKind::psi:
            case RuleKind::quest_plus:
                return read_quest_plus();
        }
        return std::nullopt;
    }

    /// The table `name`; empty if it is not there, and then what it lacks is said at [procedure].
    TableReader section(std::string_view name) {
        const Entry* entry = find(file_, name);
        const auto* table = entry == nullptr ? nullptr : std::get_if<Table>(&entry->value.data);
        if (entry != nullptr && table == nullptr) {
            problems_.add(entry->at, fmt::format("{} is {}: write it as a table [{}]", name,
                                                 kind_of(entry->value), name));
        }
        return top_.of(table == nullptr ? empty_ : *table, std::string(name),
                       entry == nullptr ? place_of_rule() : entry->at);
    }

    [[nodiscard]] Position place_of_rule() const {
        const Entry* rule = find(file_, "procedure");
        return rule == nullptr ? Position{} : rule->at;
    }

    /// A table that says what a record holds.
    template <class Record>
    Record filled(std::string_view name) {
        TableReader table = section(name);
        Record record;
        table.read_last(procedure_keys(name), &record);
        return record;
    }

    void check_tables() {
        std::vector<std::string_view> used = tables_of_rule(rule_.kind);
        main_ = place_of_rule();
        if (const Entry* entry =
                find(file_, rule_.kind == RuleKind::psi || rule_.kind == RuleKind::quest_plus
                                ? std::string_view("parameters")
                                : used.front())) {
            main_ = entry->at;
        }
        used.insert(used.end(), {"format", "procedure", "stream"});
        for (const Entry& entry : file_) {
            if (std::ranges::find(used, entry.key) == used.end()) {
                problems_.add(entry.at, fmt::format("this kind of procedure has no {}{}",
                                                    shown(entry.key), suggestion(entry.key, used)));
            }
        }
    }

    Pcg32 read_stream() {
        TableReader table = section("stream");
        StreamTable read;
        table.read_last(procedure_keys("stream"), &read);
        if (!table.has("origin")) {
            return stream({.protocol_hash = {},
                           .participant = {},
                           .purpose = std::string(purpose::procedure),
                           .seed = read.seed});
        }
        if (read.origin.size() != 32 ||
            read.origin.find_first_not_of("0123456789abcdef") != std::string::npos) {
            table.refuse("origin",
                         "origin is not 32 of the digits 0 to 9 and a to f: copy it "
                         "whole, or give a seed");
            return {0, 0};
        }
        return stream_from(read.origin);
    }

    ProcedureSpec read_staircases() {
        std::vector<StaircaseSpec> specs;
        const Entry* entry = find(file_, "staircase");
        const auto* array = entry == nullptr ? nullptr : std::get_if<Array>(&entry->value.data);
        if (array == nullptr || array->empty()) {
            problems_.add(main_, "there is no staircase: write each as a table [[staircase]]");
            return specs;
        }
        for (const Value& value : *array) {
            const auto* table = std::get_if<Table>(&value.data);
            if (table == nullptr) {
                problems_.add(value.at, fmt::format("staircase holds {}: write each as a table "
                                                    "[[staircase]]",
                                                    shown(value)));
                continue;
            }
            TableReader reader =
                top_.of(*table, fmt::format("staircase.{}", specs.size() + 1), value.at);
            specs.push_back(read_staircase(reader, specs.size() + 1));
        }
        return specs;
    }

    static StaircaseSpec read_staircase(TableReader& table, std::size_t place) {
        StaircaseTable read;
        table.read_last(procedure_keys("staircase"), &read);
        StaircaseSpec& spec = read.spec;
        if (!table.has("name")) {
            spec.name = fmt::format("staircase_{}", place);
        }
        if (read.target && !table.has("down")) {
            spec.down = 1;
        }
        if (!table.has("step_down")) {
            spec.steps_down = spec.steps_up;
        }
        if (read.target) {
            if (table.has("step_down") || spec.up != 1 || spec.down != 1) {
                table.refuse("target",
                             "target is for up = 1 and down = 1 without step_down: leave "
                             "these out, or target");
            }
            for (double& step : spec.steps_down) {
                step *= weighted_step_ratio(*read.target);
            }
        }
        table.attempt([&] { static_cast<void>(Staircase(spec)); });
        return spec;
    }

    std::optional<OutcomeModel> read_identification(TableReader& table, ModelTable& read) {
        if (rule_.kind == RuleKind::psi) {
            table.refuse("kind",
                         "psi has two outcomes: give model kind \"psychometric\", or "
                         "procedure kind \"quest_plus\"");
        }
        table.read_last(procedure_keys("model").last(1), &read);
        std::optional<OutcomeModel> model;
        table.attempt([&] { model = identification_model(read.alternatives); });
        return model;
    }

    std::optional<OutcomeModel> read_model() {
        TableReader table = section("model");
        const Keys keys = procedure_keys("model");
        ModelTable read;
        table.read(keys.first(1), &read);
        if (table.broken()) {
            return std::nullopt;
        }
        if (read.kind == ModelKind::identification) {
            return read_identification(table, read);
        }
        const bool psi = rule_.kind == RuleKind::psi;
        if (psi) {
            read.slope_as = SlopeAs::log10_slope;
        }
        table.read_last(keys.subspan(1, 3), &read);
        if (psi &&
            (read.slope_as != SlopeAs::log10_slope || read.kind != ModelKind::psychometric)) {
            table.refuse(
                read.slope_as == SlopeAs::log10_slope ? "kind" : "slope_as",
                "psi has a psychometric model with slope_as \"log10_slope\": give that, or "
                "procedure kind \"quest_plus\"");
        }
        std::optional<OutcomeModel> model;
        table.attempt([&] {
            const auto make =
                read.kind == ModelKind::covariate ? covariate_model : psychometric_model;
            model = make(read.family, read.lapse_form, read.slope_as);
        });
        return model;
    }

    /// The axes that a model names, out of the rows of a table.
    Grid read_grid(TableReader& table, const std::vector<std::string>& names) {
        const Keys all = procedure_keys(table.path());
        std::vector<Key> keys;
        AxesTable read;
        for (const std::string& name : names) {
            const auto key =
                std::ranges::find_if(all, [&](const Key& one) { return one.name == name; });
            keys.push_back(*key);
            keys.back().need = Need::required;
        }
        table.read_last(keys, &read);
        std::vector<Axis> axes;
        for (const Key& key : keys) {
            axes.push_back({std::string(key.name),
                            std::move(*std::get<std::vector<double>*>(key.slot(&read)))});
        }
        Grid grid;
        table.attempt([&] { grid = Grid(std::move(axes)); });
        return grid;
    }

    /// Weights of the values of an axis; none if they are left out.
    std::vector<double> read_prior(TableReader& table, const Axis& axis) {
        const Entry* entry = find(table.table(), axis.name);
        std::vector<double> weights;
        if (entry == nullptr) {
            return weights;
        }
        if (const auto* given = std::get_if<Table>(&entry->value.data)) {
            TableReader reader = top_.of(*given, "prior." + axis.name, entry->value.at, axis.name);
            NormalPrior prior;
            reader.read_last(kNormalPrior, &prior);
            for (const double value : axis.values) {
                const double z = (value - prior.mean) / prior.sd;
                weights.push_back(exponential(-0.5 * z * z));
            }
        } else {
            Key key = kWeights;
            key.name = axis.name;
            table.read({&key, 1}, &weights);
        }
        if (!table.broken() && weights.size() != axis.values.size()) {
            table.refuse(axis.name, fmt::format("the prior of {} has {} weights: give {}, one "
                                                "for each value",
                                                axis.name, weights.size(), axis.values.size()));
        } else if (!table.broken() && std::ranges::max(weights) <= 0.0) {
            table.refuse(axis.name, fmt::format("the prior of {} is 0 at each of its {}: give "
                                                "weights that are not all of them 0, or a mean "
                                                "and sd nearer to them",
                                                axis.name, counted(axis.values.size(), "value")));
        }
        return weights;
    }

    std::optional<ProcedureSpec> read_quest_plus() {
        std::optional<OutcomeModel> model = read_model();
        if (!model) {
            return std::nullopt;  // its problem is noted; the grids depend on it
        }
        TableReader stimuli = section("stimuli");
        TableReader parameters = section("parameters");
        TableReader priors = section("prior");
        QuestPlusSpec spec{
            .model = std::move(*model), .trials = rule_.trials, .entropy_bits = rule_.entropy_bits};
        spec.nuisance = rule_.nuisance;
        spec.stimuli = read_grid(stimuli, spec.model.stimulus);
        spec.parameters = read_grid(parameters, spec.model.parameters);
        if (!parameters.broken()) {
            for (const Axis& axis : spec.parameters.axes()) {
                spec.prior.push_back(read_prior(priors, axis));
            }
        }
        const std::vector<std::string_view> names(spec.model.parameters.begin(),
                                                  spec.model.parameters.end());
        priors.know(names);
        priors.refuse_unknown();
        return spec;
    }

    const Table& file_;
    Table empty_;
    Problems& problems_;
    TableReader top_;
    RuleTable rule_;
    Position main_;  ///< of the table to which problems of the whole are put down
};

}  // namespace

std::vector<std::string_view> tables_of_rule(RuleKind kind) {
    switch (kind) {
        case RuleKind::constant:
            return {"constant"};
        case RuleKind::staircase:
            return {"staircase"};
        case RuleKind::quest:
            return {"quest"};
        case RuleKind::psi:
        case RuleKind::quest_plus:
            return {"model", "stimuli", "parameters", "prior"};
    }
    return {};
}

Keys keys_of_rule(RuleKind kind) {
    const std::size_t more = kind == RuleKind::psi || kind == RuleKind::quest_plus ? 3
                           : kind == RuleKind::quest                               ? 1
                                                                                   : 0;
    return procedure_keys("procedure").subspan(1, more);
}

Procedure parse_procedure(std::string_view text, std::string_view file_name) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    Places places;
    return FileReader(file, problems, places).read(file_name);
}

std::optional<ProcedureSpec> read_procedure(const Table& file, Problems& problems, Places& places) {
    return FileReader(file, problems, places).rule();
}

}  // namespace palpate::protocols
