#include <fmt/format.h>

#include "protocols/file/calibration_keys.hpp"
#include "protocols/file/deformation_file.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/object_tables.hpp"
#include "protocols/file/observer_file.hpp"
#include "protocols/file/procedure_file.hpp"
#include "protocols/file/scene_file.hpp"

/// What a procedure file may say, and what people read of all files.
namespace palpate::protocols {
namespace {

constexpr Range kShare{.min = 0.0, .max = 1.0};
constexpr Range kBelowOne{.min = 0.0, .max = 1.0, .below = true};
constexpr Range kCount{.min = 1.0, .max = 100'000.0};

template <auto Member>
constexpr auto of_staircase = at<&StaircaseTable::spec, Member>;
template <std::size_t I>
constexpr auto axis = in<AxesTable, I>;

using enum Need;

// clang-format off
constexpr Key kProcedure[]{
    {.name = "kind", .slot = at<&RuleTable::kind>, .need = required,
     .meaning = "what chooses the stimuli"},
    {.name = "trials", .slot = at<&RuleTable::trials>, .range = kCount,
     .meaning = "quest, psi, quest_plus: it ends after so many"},
    {.name = "entropy_bits", .slot = at<&RuleTable::entropy_bits>, .range = {.min = 0.0},
     .meaning = "psi, quest_plus: it ends below this entropy of the posterior; 0: never. In a protocol always 0"},
    {.name = "nuisance", .slot = at<&RuleTable::nuisance>,
     .meaning = "psi, quest_plus: parameters whose uncertainty does not count (psi-marginal)"},
};

constexpr Key kStream[]{
    {.name = "seed", .slot = at<&StreamTable::seed>, .range = {0, kMaxSeed},
     .meaning = "of the random orders"},
    {.name = "origin", .slot = at<&StreamTable::origin>, .form = Form::any,
     .meaning = "32 hexadecimal digits: the random numbers of a run that is replayed, instead of seed"},
};

constexpr Key kConstant[]{
    {.name = "stimuli", .slot = at<&ConstantStimuliSpec::values>, .need = required, .form = Form::axis,
     .meaning = "every value that is shown, in any order; one that stands twice is shown twice as often"},
    {.name = "repetitions", .slot = at<&ConstantStimuliSpec::repetitions>, .range = kCount,
     .meaning = "of each value"},
    {.name = "in_blocks", .slot = at<&ConstantStimuliSpec::in_blocks>,
     .meaning = "true: each run through the list is shuffled by itself"},
    {.name = "outcomes", .slot = at<&ConstantStimuliSpec::outcomes>, .range = {2, 100},
     .meaning = "responses are 0 to outcomes - 1"},
};

constexpr Key kStaircase[]{
    {.name = "name", .slot = of_staircase<&StaircaseSpec::name>,
     .meaning = "names the estimate; left out: staircase_1, staircase_2, ..."},
    {.name = "start", .slot = of_staircase<&StaircaseSpec::start>, .need = required,
     .meaning = "first level"},
    {.name = "up", .slot = of_staircase<&StaircaseSpec::up>, .range = {1, 100},
     .meaning = "wrong responses (0) in a row that raise the level"},
    {.name = "down", .slot = of_staircase<&StaircaseSpec::down>, .range = {1, 100},
     .meaning = "right responses (1) in a row that lower the level"},
    {.name = "step_up", .slot = of_staircase<&StaircaseSpec::steps_up>, .need = required, .range = kPositive, .form = Form::one_or_more,
     .meaning = "before the first reversal, after it, ...; the last one stays"},
    {.name = "step_down", .slot = of_staircase<&StaircaseSpec::steps_down>, .range = kPositive, .form = Form::one_or_more,
     .meaning = "left out: as step_up"},
    {.name = "target", .slot = at<&StaircaseTable::target>, .range = {0.01, 0.99},
     .meaning = "instead of step_down, with up = down = 1: step_down = step_up (1 - target) / target (Kaernbach 1991)"},
    {.name = "scale", .slot = of_staircase<&StaircaseSpec::scale>,
     .meaning = "linear: level + step; db: level * 10^(step/20); log10: level * 10^step"},
    {.name = "fast_start", .slot = of_staircase<&StaircaseSpec::fast_start>,
     .meaning = "true: every response moves the level until the first reversal"},
    {.name = "lowest", .slot = of_staircase<&StaircaseSpec::lowest>,
     .meaning = "the level never goes below"},
    {.name = "highest", .slot = of_staircase<&StaircaseSpec::highest>,
     .meaning = "the level never goes above"},
    {.name = "trials", .slot = of_staircase<&StaircaseSpec::trials>, .range = kCount,
     .meaning = "it ends after so many; this or reversals is needed, in a protocol this"},
    {.name = "reversals", .slot = of_staircase<&StaircaseSpec::reversals>, .range = kCount,
     .meaning = "it ends after so many; this or trials is needed. Not in a protocol"},
    {.name = "average", .slot = of_staircase<&StaircaseSpec::average>, .range = kCount,
     .meaning = "the estimate is the mean of the last so many reversals; left out: of all"},
};

constexpr Key kQuest[]{
    {.name = "guess", .slot = at<&QuestSpec::guess>, .need = required,
     .meaning = "prior mean of the threshold, log10 units"},
    {.name = "sd", .slot = at<&QuestSpec::sd>, .need = required, .range = kPositive,
     .meaning = "prior standard deviation of the threshold, log10 units"},
    {.name = "p_threshold", .slot = at<&QuestSpec::p_threshold>, .range = {.min = 0.0, .max = 1.0, .above = true, .below = true},
     .meaning = "chance of a 1 at what is called the threshold, between gamma and 1 - delta (1 - gamma)"},
    {.name = "beta", .slot = at<&QuestSpec::beta>, .range = kPositive,
     .meaning = "slope of the Weibull function"},
    {.name = "delta", .slot = at<&QuestSpec::delta>, .range = kBelowOne,
     .meaning = "share of blind responses"},
    {.name = "gamma", .slot = at<&QuestSpec::gamma>, .range = kBelowOne,
     .meaning = "chance of a 1 far below threshold"},
    {.name = "grain", .slot = at<&QuestSpec::grain>, .range = kPositive,
     .meaning = "step of the internal table"},
    {.name = "range", .slot = at<&QuestSpec::range>, .range = kPositive,
     .meaning = "width of the internal table"},
    {.name = "rule", .slot = at<&QuestSpec::rule>,
     .meaning = "what of the posterior is shown next"},
    {.name = "lowest", .slot = at<&QuestSpec::lowest>,
     .meaning = "nothing below is shown"},
    {.name = "highest", .slot = at<&QuestSpec::highest>,
     .meaning = "nothing above is shown"},
};

constexpr Key kModel[]{
    {.name = "kind", .slot = at<&ModelTable::kind>,
     .meaning = "psychometric: 0 or 1; covariate: its threshold moves with a second stimulus; identification: which of several items"},
    {.name = "family", .slot = at<&ModelTable::family>, .need = required,
     .meaning = "psychometric, covariate: required; weibull_log10 and weibull_db name the axis of the stimulus"},
    {.name = "lapse_form", .slot = at<&ModelTable::lapse_form>,
     .meaning = "upper: g + (1 - g - l) F; two_sided: l + (1 - 2 l) F; guessing: lapses at the guess rate"},
    {.name = "slope_as", .slot = at<&ModelTable::slope_as>,
     .meaning = "which of the three the parameter is; left out: slope (psi: log10_slope)"},
    {.name = "alternatives", .slot = at<&ModelTable::alternatives>, .need = required,
     .meaning = "identification: the values of the items, increasing; response j names item j, from 0"},
};

constexpr Key kStimuli[]{
    {.name = "stimulus", .slot = axis<0>, .need = required, .form = Form::axis,
     .meaning = "every stimulus that may be shown"},
    {.name = "covariate", .slot = axis<1>, .form = Form::axis,
     .meaning = "model covariate: its second dimension"},
};

constexpr Key kParameters[]{
    {.name = "threshold", .slot = axis<0>, .form = Form::axis,
     .meaning = "psychometric, covariate"},
    {.name = "tilt", .slot = axis<1>, .form = Form::axis,
     .meaning = "covariate: change of the threshold per unit of it"},
    {.name = "slope", .slot = axis<2>, .range = kPositive, .form = Form::axis,
     .meaning = "with slope_as = \"slope\""},
    {.name = "log10_slope", .slot = axis<3>, .form = Form::axis,
     .meaning = "with slope_as = \"log10_slope\""},
    {.name = "sd", .slot = axis<4>, .range = kPositive, .form = Form::axis,
     .meaning = "with slope_as = \"sd\": 1 / slope"},
    {.name = "guess", .slot = axis<5>, .range = kShare, .form = Form::axis,
     .meaning = "chance of a 1 without a stimulus; not with two_sided"},
    {.name = "lapse", .slot = axis<6>, .range = kShare, .form = Form::axis,
     .meaning = "share of lapses"},
    {.name = "noise", .slot = axis<7>, .range = kPositive, .form = Form::axis,
     .meaning = "identification: standard deviation of the percept"},
    {.name = "bias", .slot = axis<8>, .form = Form::axis,
     .meaning = "identification: added to every percept"},
};
// clang-format on

/// All that such files may have, in the order of the reference.
constexpr std::pair<std::string_view, Keys> kTablesOfProcedures[]{
    {"procedure", kProcedure}, {"stream", kStream},        {"constant", kConstant},
    {"staircase", kStaircase}, {"quest", kQuest},          {"model", kModel},
    {"stimuli", kStimuli},     {"parameters", kParameters}};

std::vector<TableText> procedure_reference() {
    std::vector<TableText> all;
    for (const auto& [name, keys] : kTablesOfProcedures) {
        const bool several = name == "staircase";
        all.push_back({several ? "[[staircase]]" : fmt::format("[{}]", name),
                       several ? "once each; several are interleaved" : "", keys});
    }
    all.push_back({"[prior]",
                   "of parameters by name, one that is left out is uniform: a list of weights, one "
                   "for each value, or { mean = ..., sd = ... } of a normal prior",
                   {}});
    return all;
}

constexpr std::string_view kAxisText =
    "\nAn axis is a number, an increasing list, { from = ..., to = ..., count = ... } or\n"
    "{ from = ..., to = ..., step = ... }, the ends included.\n";

std::vector<TableText> tables_after_objects() {
    const auto of_hash = [](std::string_view of) {
        return fmt::format("{}left out of the study's hash as long as all are default", of);
    };
    return {
        {"[[friction]]", fmt::format("once each, 1 to {}", kMaxFrictions), keys_of<FrictionSpec>()},
        {"[safety]", of_hash(""), keys_of<SafetySpec>()},
        {"[invalid]", of_hash(""), keys_of<InvalidSpec>()},
        {"[exclusion]", of_hash("of participants, applied by palpate summary; "),
         keys_of<ExclusionSpec>()},
        {"[analysis]", of_hash("what is asked of the data; "), keys_of<AnalysisSpec>()},
        {"[design]", "", keys_of<DesignSpec>()},
        {"[timing]", "", keys_of<TimingSpec>()},
        {"[response]", of_hash(""), keys_of<ResponseSpec>()},
        {"[procedure]",
         "a rule that chooses by the answers, instead of [design]; beside these keys all of a "
         "procedure file (palpate procedure --keys), with its tables as [procedure.model], "
         "[[procedure.staircase]], ...",
         keys_of<AdaptiveSpec>()},
        {"[[run]]", fmt::format("with [procedure]: the rule runs once for each, 1 to {}", kMaxRuns),
         keys_of<RunSpec>()},
        {"[observer]", "of simulated sessions", keys_of<ObserverSpec>()},
        {"[masking]", "left out of the hash while there is no noise", keys_of<MaskingSpec>()},
        {fmt::format("[instructions.{}]", fmt::join(kLanguages, "], [instructions.")),
         "shown instead of the screen's own sentences; left out of the hash where they are not "
         "given",
         keys_of<InstructionTexts>()}};
}

std::vector<TableText> protocol_reference() {
    std::vector<TableText> all{
        {"[study]", "", keys_of<Protocol>()},
        {"[apparatus]", "", keys_of<ApparatusSpec>()},
        {"[outline]", "", keys_of<OutlineSpec>()},
        {"[surface]",
         "instead of [outline]: every object is a patch of a surface in space, for a machine of "
         "three axes",
         keys_of<SurfaceSpec>()},
        {"[[object]]",
         fmt::format("once each, {} to {} of them pictured; any number from 1 if no picture is "
                     "asked for (kind in [response])",
                     kMinPictures, kMaxPictures),
         keys_of<ObjectSpec>()}};
    for (TableText& table : object_reference()) {
        all.push_back(std::move(table));
    }
    for (TableText& table : tables_after_objects()) {
        all.push_back(std::move(table));
    }
    return all;
}

}  // namespace

Keys procedure_keys(std::string_view table) {
    // Parameters of a prior are named as those of the model.
    const auto found =
        std::ranges::find(kTablesOfProcedures, table == "prior" ? "parameters" : table,
                          &std::pair<std::string_view, Keys>::first);
    return found == std::end(kTablesOfProcedures) ? Keys() : found->second;
}

std::string procedure_key_reference() {
    return fmt::format("format = {}\n", kProcedureFormat) + reference_text(procedure_reference()) +
           std::string(kAxisText);
}

std::string key_reference() {
    return fmt::format("format = {}\n", kFormat) + reference_text(protocol_reference());
}

std::string keys_markdown() {
    return "\n### Of a protocol\n\nIt begins with `format = 1`.\n" +
           reference_markdown(protocol_reference()) +
           "\n### Of a procedure\n\nIt begins with `format = 1`.\n" + std::string(kAxisText) +
           reference_markdown(procedure_reference()) +
           "\n### Of an observer\n\nIt begins with `format = 1`.\n" +
           reference_markdown(observer_reference()) + "\n### Of a scene\n" +
           reference_markdown(scene_reference()) + "\n### Of a deformation\n" +
           reference_markdown(deformation_reference()) +
           "\n### Of a calibration\n\nIt begins with `format = 1`.\n" +
           reference_markdown(calibration_reference());
}

}  // namespace palpate::protocols
