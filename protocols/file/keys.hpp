#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "protocols/file/schema.hpp"
#include "protocols/protocol/protocol.hpp"

/// What a protocol file may say.
namespace palpate::protocols {

// What a key for an enumeration may say.
inline constexpr std::array<std::string_view, kLanguageCount> kLanguages{"en", "tr"};
inline constexpr std::array<std::string_view, 4> kPrimaryTests{"paired_t", "sign_flip",
                                                               "signed_rank", "mixed"};
template <>
inline constexpr std::array<std::string_view, 2> kWordsOf<OrderRule>{"random", "first_order"};
template <>
inline constexpr std::array<std::string_view, 3> kWordsOf<FrictionBlocks>{"interleaved", "abba",
                                                                          "blocked"};
template <>
inline constexpr std::array<std::string_view, 5> kWordsOf<DeviceClass>{"any", "haply", "comedi",
                                                                       "mouse", "board"};
template <>
inline constexpr std::array<std::string_view, 3> kWordsOf<Handedness>{"right", "left", "any"};
template <>
inline constexpr std::array<std::string_view, 2> kWordsOf<Reveal>{"ask", "never"};
template <>
inline constexpr auto kWordsOf<Language> = kLanguages;
template <>
inline constexpr std::array<std::string_view, 2> kWordsOf<Noise>{"none", "pink"};
template <>
inline constexpr std::array<std::string_view, 4> kWordsOf<ResponseKind>{
    "identification", "two_interval", "yes_no", "rating"};
template <>
inline constexpr auto kWordsOf<PrimaryTest> = kPrimaryTests;
template <>
inline constexpr std::array<std::string_view, 3> kWordsOf<Feedback>{"none", "practice", "all"};
template <>
inline constexpr std::array<std::string_view, 3> kWordsOf<Varies>{"curvature_per_m", "mu",
                                                                  "compliance_mm_per_n"};
template <>
inline constexpr std::array<std::string_view, 2> kWordsOf<StimulusAs>{"value", "log10"};

/// A law of [[friction]] and the keys that it reads beside name and law.
struct LawKeys {
    std::string_view law;
    bool rubs = true;                        ///< mu_d
    bool sticks = true;                      ///< mu_s
    bool relaxes = false;                    ///< tau_slip and tau_heal
    const engine::LawTraits* own = nullptr;  ///< of engine/friction/laws: what it reads

    /// Whether a friction of this law must have the key.
    [[nodiscard]] bool needs(std::string_view key) const;
    /// Whether a friction of this law may have the key.
    [[nodiscard]] bool reads(const Key& key) const;
    /// That a friction has the keys that this law needs, and none that it does not read.
    /// @param path  of its table
    bool check(Keys keys, const std::string& path, const Places& places, Problems& problems) const;
};
/// All laws, in the order in which they are listed.
[[nodiscard]] std::span<const LawKeys> friction_laws();
/// Null for a word that is no law.
[[nodiscard]] const LawKeys* keys_of_law(std::string_view law);
/// What is wrong with a word that is none of the laws, nor of `more`.
[[nodiscard]] std::string wrong_law(std::string_view law, WordList more = {});

/// The version of the format that this program reads: `format = 1`.
inline constexpr std::int64_t kFormat = 1;

inline constexpr std::size_t kMinPictures = 2;
inline constexpr std::size_t kMaxPictures = 9;  ///< answered by the keys 1-9
inline constexpr std::size_t kMaxObjects = 18;
inline constexpr std::size_t kMaxFrictions = 9;
inline constexpr std::size_t kMaxRuns = 9;
/// Of a session: a week at 15 s each. Planned in 20 ms, where the run limits leave an order to be
/// found.
inline constexpr std::size_t kMaxTrials = 10'000;

/// What a protocol file may say, for people: one line a key, tables as headings.
[[nodiscard]] std::string key_reference();

/// Every key of every kind of file as Markdown: unit, range, default, meaning.
[[nodiscard]] std::string keys_markdown();

}  // namespace palpate::protocols
