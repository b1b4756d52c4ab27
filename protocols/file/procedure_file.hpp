#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/file/schema.hpp"
#include "protocols/procedure/procedure.hpp"

/// Procedure files (`palpate procedure`): TOML text -> a procedure at its start. What a file may
/// say, key by key: procedure_key_reference(). Problems are reported like those of a protocol.
namespace palpate::protocols {

/// Reads a procedure file. Past this door the grids fit the model, the tables fit into memory and
/// the procedure is ready for its first trial.
/// @param file_name  for messages only
/// @throws ProtocolError with one line a problem: file:line:column, what, the value, what to do
[[nodiscard]] Procedure parse_procedure(std::string_view text, std::string_view file_name);

/// All keys for people: table, key, range, default, meaning; one line a key, tables as headings.
[[nodiscard]] std::string procedure_key_reference();

// ----------------------------------------------------------------------- private to protocols/file

inline constexpr std::int64_t kProcedureFormat = 1;

enum class RuleKind : std::uint8_t { constant, staircase, quest, psi, quest_plus };
enum class ModelKind : std::uint8_t { psychometric, covariate, identification };

template <>
inline constexpr std::array<std::string_view, 5> kWordsOf<RuleKind>{"constant", "staircase",
                                                                    "quest", "psi", "quest_plus"};
template <>
inline constexpr std::array<std::string_view, 3> kWordsOf<ModelKind>{"psychometric", "covariate",
                                                                     "identification"};
template <>
inline constexpr auto kWordsOf<StepScale> = kStepScales;
template <>
inline constexpr auto kWordsOf<QuestRule> = kQuestRules;
template <>
inline constexpr auto kWordsOf<Family> = kFamilyWords;
template <>
inline constexpr auto kWordsOf<LapseForm> = kLapseWords;
template <>
inline constexpr auto kWordsOf<SlopeAs> = kSlopeWords;

/// [procedure]
struct RuleTable {
    RuleKind kind = RuleKind::constant;
    std::size_t trials = 64;
    double entropy_bits = 0.0;
    std::vector<std::string> nuisance{};
};

/// [stream]
struct StreamTable {
    std::uint64_t seed = 0;
    std::string origin{};
};

/// [[staircase]]
struct StaircaseTable {
    StaircaseSpec spec{.name = "", .steps_down = {}};
    std::optional<double> target{};
};

/// [model]
struct ModelTable {
    ModelKind kind = ModelKind::psychometric;
    Family family = Family::normal;
    LapseForm lapse_form = LapseForm::upper;
    SlopeAs slope_as = SlopeAs::slope;
    std::vector<double> alternatives{};
};

/// [stimuli] and [parameters]: values of an axis in the order of their rows.
using AxesTable = std::array<std::vector<double>, 9>;

/// The keys of this table; of [prior] those of [parameters].
[[nodiscard]] Keys procedure_keys(std::string_view table);

/// The tables that each kind uses, beside [procedure] and [stream].
[[nodiscard]] std::vector<std::string_view> tables_of_rule(RuleKind kind);
/// The keys of [procedure] that each kind reads, beside kind.
[[nodiscard]] Keys keys_of_rule(RuleKind kind);

/// The rule in the tables of a procedure file, wherever they stand; [stream] is not looked at.
/// Nothing if there are problems. @param places  gets those of all that was read
[[nodiscard]] std::optional<ProcedureSpec> read_procedure(const Table& file,
                                                          Problems& problems,
                                                          Places& places);

/// The tables as a procedure file: keys in the order of their rows, numbers as short as they can
/// be. Read and written again it is the same text. [stream] is left out.
/// @pre read_procedure() finds no problem
[[nodiscard]] std::string procedure_text(const Table& file);

}  // namespace palpate::protocols
