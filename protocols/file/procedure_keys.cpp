#include "protocols/file/procedure_keys.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "protocols/file/procedure_file.hpp"
#include "protocols/procedure/outcome_model.hpp"
#include "protocols/procedure/quest.hpp"
#include "protocols/procedure/staircase.hpp"

namespace palpate::protocols {
namespace {

constexpr std::array<std::string_view, 5> kKinds{"constant", "staircase", "quest", "psi",
                                                 "quest_plus"};
constexpr std::array<std::string_view, 3> kModels{"psychometric", "covariate", "identification"};

constexpr double kMostSeed = 9223372036854775807.0;  // TOML integers have 63 bits and a sign
constexpr Range kPositive{.lowest = 0.0, .above = true};
constexpr Range kShare{.lowest = 0.0, .highest = 1.0};
constexpr Range kCount{.lowest = 1.0, .highest = 100'000.0};

// clang-format off
constexpr std::array kKeys{
    ProcedureKey{.table = "procedure", .name = "kind", .kind = KeyKind::word, .required = true, .words = kKinds,
                 .meaning = "what chooses the stimuli"},
    ProcedureKey{.table = "procedure", .name = "trials", .kind = KeyKind::integer, .range = kCount, .otherwise = 64.0,
                 .meaning = "quest, psi, quest_plus: it ends after so many"},
    ProcedureKey{.table = "procedure", .name = "entropy_bits", .range = {.lowest = 0.0}, .otherwise = 0.0,
                 .meaning = "psi, quest_plus: it ends below this entropy of the posterior; 0: never"},
    ProcedureKey{.table = "procedure", .name = "nuisance", .kind = KeyKind::names,
                 .meaning = "psi, quest_plus: parameters whose uncertainty does not count (psi-marginal)"},

    ProcedureKey{.table = "stream", .name = "seed", .kind = KeyKind::integer, .range = {.lowest = 0.0, .highest = kMostSeed}, .otherwise = 0.0,
                 .meaning = "of the random orders"},
    ProcedureKey{.table = "stream", .name = "origin", .kind = KeyKind::text,
                 .meaning = "32 hexadecimal digits: the random numbers of a run that is replayed, instead of seed"},

    ProcedureKey{.table = "constant", .name = "stimuli", .kind = KeyKind::axis, .required = true,
                 .meaning = "every value that is shown"},
    ProcedureKey{.table = "constant", .name = "repetitions", .kind = KeyKind::integer, .range = kCount, .otherwise = 10.0,
                 .meaning = "of each value"},
    ProcedureKey{.table = "constant", .name = "in_blocks", .kind = KeyKind::flag, .otherwise = 0.0,
                 .meaning = "true: each run through the list is shuffled by itself"},
    ProcedureKey{.table = "constant", .name = "outcomes", .kind = KeyKind::integer, .range = {.lowest = 2.0, .highest = 100.0}, .otherwise = 2.0,
                 .meaning = "responses are 0 to outcomes - 1"},

    ProcedureKey{.table = "staircase", .name = "name", .kind = KeyKind::name,
                 .meaning = "names the estimate; left out: staircase_1, staircase_2, ..."},
    ProcedureKey{.table = "staircase", .name = "start", .required = true,
                 .meaning = "first level"},
    ProcedureKey{.table = "staircase", .name = "up", .kind = KeyKind::integer, .range = {.lowest = 1.0, .highest = 100.0}, .otherwise = 1.0,
                 .meaning = "wrong responses (0) in a row that raise the level"},
    ProcedureKey{.table = "staircase", .name = "down", .kind = KeyKind::integer, .range = {.lowest = 1.0, .highest = 100.0}, .otherwise = 2.0,
                 .meaning = "right responses (1) in a row that lower the level"},
    ProcedureKey{.table = "staircase", .name = "step_up", .kind = KeyKind::one_or_more, .range = kPositive, .required = true,
                 .meaning = "before the first reversal, after it, ...; the last one stays"},
    ProcedureKey{.table = "staircase", .name = "step_down", .kind = KeyKind::one_or_more, .range = kPositive,
                 .meaning = "left out: as step_up"},
    ProcedureKey{.table = "staircase", .name = "target", .range = {.lowest = 0.01, .highest = 0.99},
                 .meaning = "instead of step_down, with up = down = 1: step_down = step_up (1 - target) / target (Kaernbach 1991)"},
    ProcedureKey{.table = "staircase", .name = "scale", .kind = KeyKind::word, .otherwise = 0.0, .words = kStepScales,
                 .meaning = "linear: level + step; db: level * 10^(step/20); log10: level * 10^step"},
    ProcedureKey{.table = "staircase", .name = "fast_start", .kind = KeyKind::flag, .otherwise = 0.0,
                 .meaning = "true: every response moves the level until the first reversal"},
    ProcedureKey{.table = "staircase", .name = "lowest", .otherwise = -1e10, .meaning = "the level never goes below"},
    ProcedureKey{.table = "staircase", .name = "highest", .otherwise = 1e10, .meaning = "the level never goes above"},
    ProcedureKey{.table = "staircase", .name = "trials", .kind = KeyKind::integer, .range = kCount,
                 .meaning = "it ends after so many; this or reversals is needed"},
    ProcedureKey{.table = "staircase", .name = "reversals", .kind = KeyKind::integer, .range = kCount,
                 .meaning = "it ends after so many; this or trials is needed"},
    ProcedureKey{.table = "staircase", .name = "average", .kind = KeyKind::integer, .range = kCount,
                 .meaning = "the estimate is the mean of the last so many reversals; left out: of all"},

    ProcedureKey{.table = "quest", .name = "guess", .required = true, .meaning = "prior mean of the threshold, log10 units"},
    ProcedureKey{.table = "quest", .name = "sd", .range = kPositive, .required = true,
                 .meaning = "prior standard deviation of the threshold, log10 units"},
    ProcedureKey{.table = "quest", .name = "p_threshold", .range = kShare, .otherwise = 0.82,
                 .meaning = "chance of a 1 at what is called the threshold"},
    ProcedureKey{.table = "quest", .name = "beta", .range = kPositive, .otherwise = 3.5, .meaning = "slope of the Weibull function"},
    ProcedureKey{.table = "quest", .name = "delta", .range = kShare, .otherwise = 0.01, .meaning = "share of blind responses"},
    ProcedureKey{.table = "quest", .name = "gamma", .range = kShare, .otherwise = 0.5, .meaning = "chance of a 1 far below threshold"},
    ProcedureKey{.table = "quest", .name = "grain", .range = kPositive, .otherwise = 0.01, .meaning = "step of the internal table"},
    ProcedureKey{.table = "quest", .name = "range", .range = kPositive, .otherwise = 5.0, .meaning = "width of the internal table"},
    ProcedureKey{.table = "quest", .name = "rule", .kind = KeyKind::word, .otherwise = 0.0, .words = kQuestRules,
                 .meaning = "what of the posterior is shown next"},
    ProcedureKey{.table = "quest", .name = "lowest", .otherwise = -1e10, .meaning = "nothing below is shown"},
    ProcedureKey{.table = "quest", .name = "highest", .otherwise = 1e10, .meaning = "nothing above is shown"},

    ProcedureKey{.table = "model", .name = "kind", .kind = KeyKind::word, .otherwise = 0.0, .words = kModels,
                 .meaning = "psychometric: 0 or 1; covariate: its threshold moves with a second stimulus; identification: which of several items"},
    ProcedureKey{.table = "model", .name = "family", .kind = KeyKind::word, .words = kFamilyWords,
                 .meaning = "psychometric, covariate: required; weibull_log10 and weibull_db name the axis of the stimulus"},
    ProcedureKey{.table = "model", .name = "lapse_form", .kind = KeyKind::word, .otherwise = 0.0, .words = kLapseWords,
                 .meaning = "upper: g + (1 - g - l) F; two_sided: l + (1 - 2 l) F; guessing: lapses at the guess rate"},
    ProcedureKey{.table = "model", .name = "slope_as", .kind = KeyKind::word, .words = kSlopeWords,
                 .meaning = "which of the three the parameter is; left out: slope (psi: log10_slope)"},
    ProcedureKey{.table = "model", .name = "alternatives", .kind = KeyKind::numbers,
                 .meaning = "identification: the values of the items, increasing; response j names item j, from 0"},

    ProcedureKey{.table = "stimuli", .name = "stimulus", .kind = KeyKind::axis, .required = true,
                 .meaning = "every stimulus that may be shown"},
    ProcedureKey{.table = "stimuli", .name = "covariate", .kind = KeyKind::axis,
                 .meaning = "model covariate: its second dimension"},

    ProcedureKey{.table = "parameters", .name = "threshold", .kind = KeyKind::axis, .meaning = "psychometric, covariate"},
    ProcedureKey{.table = "parameters", .name = "tilt", .kind = KeyKind::axis, .meaning = "covariate: change of the threshold per unit of it"},
    ProcedureKey{.table = "parameters", .name = "slope", .kind = KeyKind::axis, .range = kPositive, .meaning = "with slope_as = \"slope\""},
    ProcedureKey{.table = "parameters", .name = "log10_slope", .kind = KeyKind::axis, .meaning = "with slope_as = \"log10_slope\""},
    ProcedureKey{.table = "parameters", .name = "sd", .kind = KeyKind::axis, .range = kPositive, .meaning = "with slope_as = \"sd\": 1 / slope"},
    ProcedureKey{.table = "parameters", .name = "guess", .kind = KeyKind::axis, .range = kShare, .meaning = "chance of a 1 without a stimulus; not with two_sided"},
    ProcedureKey{.table = "parameters", .name = "lapse", .kind = KeyKind::axis, .range = kShare, .meaning = "share of lapses"},
    ProcedureKey{.table = "parameters", .name = "noise", .kind = KeyKind::axis, .range = kPositive, .meaning = "identification: standard deviation of the percept"},
    ProcedureKey{.table = "parameters", .name = "bias", .kind = KeyKind::axis, .meaning = "identification: added to every percept"},
};
// clang-format on

std::string kind_text(const ProcedureKey& key) {
    switch (key.kind) {
        case KeyKind::number:
        case KeyKind::integer:
        case KeyKind::one_or_more: {
            std::string range = range_words(key.range);
            return key.kind == KeyKind::integer     ? "integer, " + range
                 : key.kind == KeyKind::one_or_more ? "number or list, " + range
                                                    : range;
        }
        case KeyKind::flag:
            return "true or false";
        case KeyKind::word:
            return fmt::format("{}", fmt::join(key.words, ", "));
        case KeyKind::name:
            return "letters a-z, digits and _";
        case KeyKind::text:
            return "text";
        case KeyKind::numbers:
            return "list of numbers";
        case KeyKind::names:
            return "list of names";
        case KeyKind::axis:
            return std::isfinite(key.range.lowest) ? "axis, " + range_words(key.range) : "axis";
        case KeyKind::prior:
            return "prior";
    }
    return {};
}

std::string default_text(const ProcedureKey& key) {
    if (key.required) {
        return "required";
    }
    if (!key.otherwise) {
        return "-";
    }
    if (key.kind == KeyKind::flag) {
        return "false";
    }
    if (key.kind == KeyKind::word) {
        return std::string(key.words[static_cast<std::size_t>(*key.otherwise)]);
    }
    return fmt::format("{}", *key.otherwise);
}

}  // namespace

std::string range_words(const Range& range) {
    if (range.highest == kMostSeed) {
        return "0 to 9223372036854775807";
    }
    const bool low = std::isfinite(range.lowest);
    const bool high = std::isfinite(range.highest);
    if (!low && !high) {
        return "any finite number";
    }
    if (!high) {
        return range.above ? fmt::format("above {}", range.lowest)
                           : fmt::format("{} or more", range.lowest);
    }
    return range.above ? fmt::format("above {}, at most {}", range.lowest, range.highest)
                       : fmt::format("{} to {}", range.lowest, range.highest);
}

std::span<const ProcedureKey> procedure_keys() noexcept {
    return kKeys;
}

std::string procedure_key_reference() {
    std::string text = fmt::format("format = {}\n", kProcedureFormat);
    std::string_view table;
    for (const ProcedureKey& key : kKeys) {
        if (key.table != table) {
            table = key.table;
            text += table == "staircase" ? "\n[[staircase]]  once each; several are interleaved\n"
                                         : fmt::format("\n[{}]\n", table);
        }
        text += fmt::format("    {:<14} {:<44} {:<13} {}\n", key.name, kind_text(key),
                            default_text(key), key.meaning);
    }
    text +=
        "\n[prior]  of parameters by name; one that is left out is uniform\n"
        "    a list of weights, one for each value, or { mean = ..., sd = ... } of a normal prior\n"
        "\nAn axis is a number, an increasing list, { from = ..., to = ..., count = ... } or\n"
        "{ from = ..., to = ..., step = ... }, the ends included.\n";
    return text;
}

}  // namespace palpate::protocols
