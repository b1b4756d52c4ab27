#include "protocols/file/procedure_file.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/file/procedure_tables.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/read_text.hpp"
#include "protocols/file/section.hpp"

namespace palpate::protocols {
namespace {

enum class Kind : std::uint8_t { constant, staircase, quest, psi, quest_plus };

/// The words of procedure_keys() whose numbers these are.
enum class Model : std::uint8_t { psychometric, covariate, identification };

/// The tables that each kind uses, beside [procedure] and [stream].
std::vector<std::string_view> tables_of(Kind kind) {
    switch (kind) {
        case Kind::constant:
            return {"constant"};
        case Kind::staircase:
            return {"staircase"};
        case Kind::quest:
            return {"quest"};
        case Kind::psi:
        case Kind::quest_plus:
            return {"model", "stimuli", "parameters", "prior"};
    }
    return {};
}

class FileReader {
public:
    FileReader(const Table& file, Problems& problems) : file_(file), problems_(problems) {}

    ProcedureFile read(std::string_view file_name) {
        check_format(file_name);
        std::optional<ProcedureSpec> spec = read_rule();
        const Pcg32 random = read_stream();
        problems_.throw_if_any(file_name);
        std::optional<Procedure> ready;
        attempt([&] { ready.emplace(*spec, random); });
        problems_.throw_if_any(file_name);
        return {std::move(*spec), std::move(ready.value())};
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
    const Entry* find(std::string_view name) const {
        const auto entry = std::find_if(file_.begin(), file_.end(),
                                        [name](const Entry& e) { return e.key == name; });
        return entry == file_.end() ? nullptr : &*entry;
    }

    template <class Make>
    void attempt(Make&& make) {
        try {
            make();
        } catch (const std::invalid_argument& e) {
            Position at = main_;
            for (const Entry& entry : file_) {
                if (const auto* table = std::get_if<Table>(&entry.value.data)) {
                    at = spoken_of(*table, e.what(), at);
                }
            }
            problems_.add(at, e.what());
        }
    }

    std::optional<ProcedureSpec> read_rule() {
        Section procedure = section("procedure");
        kind_ = static_cast<Kind>(procedure.word("kind"));
        if (procedure.broken()) {  // all else depends on the kind
            return std::nullopt;
        }
        check_tables();
        return read_spec(procedure);
    }

    void check_format(std::string_view file_name) {
        const Entry* entry = find("format");
        const auto* version =
            entry == nullptr ? nullptr : std::get_if<std::int64_t>(&entry->value.data);
        if (version == nullptr || *version != kProcedureFormat) {
            throw ProtocolError(
                fmt::format("{}:{}:{}: format is {}: give format = {} as the first line", file_name,
                            entry == nullptr ? 1 : entry->value.at.line,
                            entry == nullptr ? 1 : entry->value.at.column,
                            entry == nullptr ? "missing" : shown(entry->value), kProcedureFormat));
        }
    }

    /// The table `name`, empty if it is not there.
    Section section(std::string_view name) {
        const Entry* entry = find(name);
        const auto* table = entry == nullptr ? nullptr : std::get_if<Table>(&entry->value.data);
        if (entry != nullptr && table == nullptr) {
            problems_.add(entry->at, fmt::format("{} is {}: write it as a table [{}]", name,
                                                 kind_of(entry->value), name));
        }
        return {table == nullptr ? empty_ : *table, name, fmt::format("[{}]", name),
                entry == nullptr ? Position{} : entry->at, problems_};
    }

    void check_tables() {
        std::vector<std::string_view> used = tables_of(kind_);
        main_ = Position{};
        if (const Entry* entry = find(kind_ == Kind::psi || kind_ == Kind::quest_plus
                                          ? std::string_view("parameters")
                                          : used.front())) {
            main_ = entry->at;
        }
        used.insert(used.end(), {"format", "procedure", "stream"});
        for (const Entry& entry : file_) {
            if (std::find(used.begin(), used.end(), entry.key) == used.end()) {
                problems_.add(entry.at, fmt::format("this kind of procedure has no {}{}",
                                                    shown(entry.key), suggestion(entry.key, used)));
            }
        }
    }

    Pcg32 read_stream() {
        Section section = this->section("stream");
        const std::uint64_t seed = section.seed("seed");
        const std::string origin = section.text("origin");
        const bool wanted = section.has("origin");
        if (wanted && (origin.size() != 32 ||
                       origin.find_first_not_of("0123456789abcdef") != std::string::npos)) {
            section.refuse("origin",
                           "origin is not 32 of the digits 0 to 9 and a to f: copy it "
                           "whole, or give a seed");
            return {0, 0};
        }
        section.refuse_unknown();
        return wanted ? stream_from(origin)
                      : stream({.protocol_hash = {},
                                .participant = {},
                                .purpose = std::string(purpose::procedure),
                                .seed = seed});
    }

    std::optional<ProcedureSpec> read_spec(Section& procedure) {
        const auto keys = [&](std::initializer_list<std::string_view> known) {
            procedure.refuse_unknown(std::vector<std::string_view>(known));
        };
        switch (kind_) {
            case Kind::constant:
                keys({"kind"});
                return read_constant();
            case Kind::staircase:
                keys({"kind"});
                return read_staircases();
            case Kind::quest:
                keys({"kind", "trials"});
                return read_quest(procedure.count("trials"));
            case Kind::psi:
            case Kind::quest_plus:
                keys({"kind", "trials", "entropy_bits", "nuisance"});
                return read_quest_plus(procedure);
        }
        return std::nullopt;
    }

    ProcedureSpec read_constant() {
        Section table = section("constant");
        ConstantStimuliSpec spec;
        spec.values = table.axis("stimuli").values;
        spec.repetitions = table.count("repetitions");
        spec.in_blocks = table.flag("in_blocks");
        spec.outcomes = table.count("outcomes");
        table.refuse_unknown();
        return spec;
    }

    ProcedureSpec read_staircases() {
        std::vector<StaircaseSpec> specs;
        const Entry* entry = find("staircase");
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
            Section section(*table, "staircase", fmt::format("[[staircase]] {}", specs.size() + 1),
                            value.at, problems_);
            specs.push_back(read_staircase(section, specs.size() + 1));
        }
        return specs;
    }

    static StaircaseSpec read_staircase(Section& table, std::size_t place) {
        StaircaseSpec spec;
        spec.name = table.has("name") ? table.text("name") : fmt::format("staircase_{}", place);
        spec.start = table.number("start");
        spec.up = table.count("up");
        spec.down = table.has("target") && !table.has("down") ? 1 : table.count("down");
        spec.steps_up = table.numbers("step_up");
        spec.steps_down = table.has("step_down") ? table.numbers("step_down") : spec.steps_up;
        if (const auto target = table.number_if("target")) {
            if (table.has("step_down") || spec.up != 1 || spec.down != 1) {
                table.refuse("target",
                             "target is for up = 1 and down = 1 without step_down: leave "
                             "these out, or target");
            }
            for (double& step : spec.steps_down) {
                step *= weighted_step_ratio(*target);
            }
        }
        spec.scale = static_cast<StepScale>(table.word("scale"));
        spec.fast_start = table.flag("fast_start");
        spec.lowest = table.number("lowest");
        spec.highest = table.number("highest");
        spec.trials = table.count("trials");
        spec.reversals = table.count("reversals");
        spec.average = table.count("average");
        table.refuse_unknown();
        table.attempt([&] { static_cast<void>(Staircase(spec)); });
        return spec;
    }

    ProcedureSpec read_quest(std::size_t trials) {
        Section table = section("quest");
        QuestSpec spec;
        spec.guess = table.number("guess");
        spec.sd = table.number("sd");
        spec.p_threshold = table.number("p_threshold");
        spec.beta = table.number("beta");
        spec.delta = table.number("delta");
        spec.gamma = table.number("gamma");
        spec.grain = table.number("grain");
        spec.range = table.number("range");
        spec.rule = static_cast<QuestRule>(table.word("rule"));
        spec.lowest = table.number("lowest");
        spec.highest = table.number("highest");
        spec.trials = trials;
        table.refuse_unknown();
        return spec;
    }

    std::optional<OutcomeModel> read_model() {
        Section table = section("model");
        const auto model = static_cast<Model>(table.word("kind"));
        if (table.broken()) {
            return std::nullopt;
        }
        std::optional<OutcomeModel> read;
        if (model == Model::identification) {
            if (kind_ == Kind::psi) {
                table.refuse("kind",
                             "psi has two outcomes: give model kind \"psychometric\", or "
                             "procedure kind \"quest_plus\"");
            }
            const std::vector<double> items = table.numbers("alternatives");
            table.refuse_unknown(std::vector<std::string_view>{"kind", "alternatives"});
            table.attempt([&] { read = identification_model(items); });
            return read;
        }
        const auto family = static_cast<Family>(table.word("family"));
        const auto form = static_cast<LapseForm>(table.word("lapse_form"));
        const bool psi = kind_ == Kind::psi;
        SlopeAs slope_as = psi ? SlopeAs::log10_slope : SlopeAs::slope;
        if (table.has("slope_as")) {
            slope_as = static_cast<SlopeAs>(table.word("slope_as"));
        }
        if (psi && (slope_as != SlopeAs::log10_slope || model != Model::psychometric)) {
            table.refuse(
                slope_as == SlopeAs::log10_slope ? "kind" : "slope_as",
                "psi has a psychometric model with slope_as \"log10_slope\": give that, or "
                "procedure kind \"quest_plus\"");
        }
        table.refuse_unknown(
            std::vector<std::string_view>{"kind", "family", "lapse_form", "slope_as"});
        table.attempt([&] {
            read = model == Model::covariate ? covariate_model(family, form, slope_as)
                                             : psychometric_model(family, form, slope_as);
        });
        return read;
    }

    static std::vector<std::string_view> views(const std::vector<std::string>& names) {
        return {names.begin(), names.end()};
    }

    static Grid read_grid(Section& table, const std::vector<std::string>& names) {
        std::vector<Axis> axes;
        for (const std::string& name : names) {
            axes.push_back(table.axis(name));
        }
        table.refuse_unknown(views(names));
        Grid grid;
        table.attempt([&] { grid = Grid(std::move(axes)); });
        return grid;
    }

    std::optional<ProcedureSpec> read_quest_plus(Section& procedure) {
        const std::size_t trials = procedure.count("trials");
        const double entropy_bits = procedure.number("entropy_bits");
        std::vector<std::string> nuisance = procedure.names("nuisance");
        std::optional<OutcomeModel> model = read_model();
        if (!model) {
            return std::nullopt;  // its problem is noted; the grids depend on it
        }
        Section stimuli = section("stimuli");
        Section parameters = section("parameters");
        Section priors = section("prior");
        QuestPlusSpec spec{
            .model = std::move(*model), .trials = trials, .entropy_bits = entropy_bits};
        spec.nuisance = std::move(nuisance);
        spec.stimuli = read_grid(stimuli, spec.model.stimulus);
        spec.parameters = read_grid(parameters, spec.model.parameters);
        if (!parameters.broken()) {
            for (const Axis& axis : spec.parameters.axes()) {
                spec.prior.push_back(priors.prior(axis));
            }
        }
        priors.refuse_unknown(views(spec.model.parameters));
        return spec;
    }

    const Table& file_;
    Table empty_;
    Problems& problems_;
    Kind kind_ = Kind::constant;
    Position main_;  ///< of the table to which problems of the whole are put down
};

}  // namespace

ProcedureFile parse_procedure(std::string_view text, std::string_view file_name) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    return FileReader(file, problems).read(file_name);
}

std::optional<ProcedureSpec> read_procedure(const Table& file, Problems& problems) {
    return FileReader(file, problems).rule();
}

ProcedureFile load_procedure(const std::filesystem::path& file) {
    return parse_procedure(read_text(file, kMostDocument), file.string());
}

}  // namespace palpate::protocols
