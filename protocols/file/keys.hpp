#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "protocols/protocol/protocol.hpp"

/// What a protocol file may say. One row a key; reading, range checks, writing and the reference for
/// people are all driven by these rows, so that they cannot disagree.
namespace palpate::protocols {

/// When a key has to be there.
enum class Need : std::uint8_t {
    required,
    optional,   ///< left out: the default member of the struct
    factorial,  ///< required without [procedure]
    gos,        ///< friction coefficients: required by the law "gos", refused with "frictionless"
    gos_optional,
    two_curve,  ///< curvature: required by an object of two curves, refused with a free form
};

/// How a text is restricted.
enum class Text : std::uint8_t {
    name,   ///< [a-z0-9_]+, at most 64
    free,   ///< one line, at most 200 bytes
    lines,  ///< lines of a screen, at most kMostInstruction bytes and kMostInstructionLines
};

/// Longest instruction, bytes: it still fits onto a screen of 800 x 600 pixels in a legible size.
inline constexpr std::size_t kMostInstruction = 600;
inline constexpr std::size_t kMostInstructionLines = 8;

/// One key of a table that becomes a Record.
template <class Record>
struct Key {
    std::string_view name;  ///< carries the unit
    std::variant<double Record::*,
                 std::uint64_t Record::*,
                 bool Record::*,
                 std::string Record::*,
                 engine::Vec2 Record::*,
                 OrderRule Record::*,
                 FrictionBlocks Record::*,
                 DeviceClass Record::*,
                 Handedness Record::*,
                 Noise Record::*,
                 Language Record::*,
                 ResponseKind Record::*,
                 Feedback Record::*,
                 Varies Record::*,
                 StimulusAs Record::*>
        member;
    Need need = Need::optional;
    double lowest = 0.0;  ///< in the file's unit; of each coordinate for a point
    double highest = 0.0;
    bool above = false;   ///< `lowest` itself is refused
    double per_si = 1.0;  ///< file value = SI value * per_si: 1000 for mm and ms, 0.001 for 1/ms
    Text text = Text::name;
    bool late = false;  ///< younger than studies that are kept: not in their text while default
    std::string_view meaning;
};

// What a key for an enumeration may say, by its numbers.
inline constexpr std::array<std::string_view, 2> kOrderRules{"random", "first_order"};
inline constexpr std::array<std::string_view, 3> kFrictionBlocks{"interleaved", "abba", "blocked"};
inline constexpr std::array<std::string_view, 4> kDeviceClasses{"any", "haply", "comedi", "mouse"};
inline constexpr std::array<std::string_view, 3> kHandedness{"right", "left", "any"};
inline constexpr std::array<std::string_view, kLanguageCount> kLanguages{"en", "tr"};
inline constexpr std::array<std::string_view, 2> kNoises{"none", "pink"};
inline constexpr std::array<std::string_view, 4> kResponseKinds{"identification", "two_interval",
                                                                "yes_no", "rating"};
inline constexpr std::array<std::string_view, 3> kFeedbacks{"none", "practice", "all"};
inline constexpr std::array<std::string_view, 2> kVaries{"curvature_per_m", "mu"};
inline constexpr std::array<std::string_view, 2> kStimulusAs{"value", "log10"};

[[nodiscard]] constexpr std::span<const std::string_view> words_of(OrderRule) {
    return kOrderRules;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(FrictionBlocks) {
    return kFrictionBlocks;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(DeviceClass) {
    return kDeviceClasses;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(Handedness) {
    return kHandedness;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(Language) {
    return kLanguages;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(ResponseKind) {
    return kResponseKinds;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(Feedback) {
    return kFeedbacks;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(Varies) {
    return kVaries;
}
[[nodiscard]] constexpr std::span<const std::string_view> words_of(StimulusAs) {
    return kStimulusAs;
}

[[nodiscard]] constexpr std::span<const std::string_view> words_of(Noise) {
    return kNoises;
}

/// Its word in a file.
template <class Enumeration>
[[nodiscard]] constexpr std::string_view word_of(Enumeration value) {
    return words_of(value)[static_cast<std::size_t>(value)];
}

// Counts are std::size_t in the structs; on every platform we build for that is std::uint64_t.
static_assert(std::is_same_v<std::size_t, std::uint64_t>);

/// Rows of [study], [[object]], ... by the struct that they fill. [study] fills Protocol itself.
template <class Record>
[[nodiscard]] std::span<const Key<Record>> keys_of();
template <>
std::span<const Key<Protocol>> keys_of();
template <>
std::span<const Key<ApparatusSpec>> keys_of();
template <>
std::span<const Key<OutlineSpec>> keys_of();
template <>
std::span<const Key<ObjectSpec>> keys_of();
template <>
std::span<const Key<FrictionSpec>> keys_of();
template <>
std::span<const Key<SafetySpec>> keys_of();
template <>
std::span<const Key<InvalidSpec>> keys_of();
template <>
std::span<const Key<ExclusionSpec>> keys_of();
template <>
std::span<const Key<DesignSpec>> keys_of();
template <>
std::span<const Key<TimingSpec>> keys_of();
template <>
std::span<const Key<ResponseSpec>> keys_of();
template <>
std::span<const Key<AdaptiveSpec>> keys_of();
template <>
std::span<const Key<RunSpec>> keys_of();
template <>
std::span<const Key<ObserverSpec>> keys_of();
template <>
std::span<const Key<MaskingSpec>> keys_of();
template <>
std::span<const Key<InstructionTexts>> keys_of();

/// Whether the canonical text leaves this key out: it is late, and the member is the default's.
template <class Record>
[[nodiscard]] bool left_out(const Key<Record>& key, const Record& record);

/// The version of the format that this program reads: `format = 1`.
inline constexpr std::int64_t kFormat = 1;

/// Of a seed: TOML integers have 63 bits and a sign.
inline constexpr double kMostSeed = 9223372036854775807.0;
inline constexpr std::size_t kMinPictures = 2;
inline constexpr std::size_t kMaxPictures = 9;  ///< answered by the keys 1-9
inline constexpr std::size_t kMaxObjects = 18;
inline constexpr std::size_t kMaxFrictions = 9;
inline constexpr std::size_t kMaxRuns = 9;
/// Of a session: a week at 15 s each. Planned in 20 ms, where the run limits leave an order to be found.
inline constexpr std::size_t kMaxTrials = 10'000;

/// "0 to 50", "above 0, at most 50", "letters a-z, digits and _", ...
template <class Record>
[[nodiscard]] std::string range_of(const Key<Record>& key);

/// All keys for people: table, key, range, default, meaning; one line a key, tables as headings.
[[nodiscard]] std::string key_reference();

}  // namespace palpate::protocols
