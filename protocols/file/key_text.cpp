#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "protocols/file/keys.hpp"
#include "protocols/file/object_tables.hpp"

/// What people read about the keys: ranges, defaults, the reference.
namespace palpate::protocols {
namespace {

using enum Need;

/// What a key for an enumeration may say, nothing for other keys.
template <class Record>
std::span<const std::string_view> words_for(const Key<Record>& key) {
    return std::visit(
        [](auto member) -> std::span<const std::string_view> {
            using Member = std::decay_t<decltype(std::declval<Record>().*member)>;
            if constexpr (std::is_enum_v<Member>) {
                return words_of(Member{});
            } else {
                return {};
            }
        },
        key.member);
}

template <class Record>
std::string default_of(const Key<Record>& key) {
    if (key.need == required || key.need == factorial || key.need == gos || key.need == two_curve) {
        return "required";
    }
    [[maybe_unused]] static const Record defaults{};
    return std::visit(
        [&key](auto member) -> std::string {
            const auto& value = defaults.*member;
            using Member = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Member, engine::Vec2>) {
                return fmt::format("[{}, {}]", value.x * key.per_si, value.y * key.per_si);
            } else if constexpr (std::is_same_v<Member, double>) {
                return fmt::format("{}", value * key.per_si);
            } else if constexpr (std::is_enum_v<Member>) {
                return std::string(word_of(value));
            } else {
                return fmt::format("{}", value);
            }
        },
        key.member);
}

template <class Record>
std::string section(std::string_view heading) {
    std::string text = fmt::format("\n{}\n", heading);
    for (const Key<Record>& key : keys_of<Record>()) {
        text += fmt::format("    {:<22} {:<28} {:<11} {}\n", key.name, range_of(key),
                            default_of(key), key.meaning);
    }
    return text;
}

}  // namespace

template <class Record>
bool left_out(const Key<Record>& key, const Record& record) {
    static const Record defaults{};
    return key.late &&
           std::visit([&](auto member) { return record.*member == defaults.*member; }, key.member);
}
template bool left_out(const Key<Protocol>&, const Protocol&);
template bool left_out(const Key<ApparatusSpec>&, const ApparatusSpec&);
template bool left_out(const Key<OutlineSpec>&, const OutlineSpec&);
template bool left_out(const Key<ObjectSpec>&, const ObjectSpec&);
template bool left_out(const Key<FrictionSpec>&, const FrictionSpec&);
template bool left_out(const Key<SafetySpec>&, const SafetySpec&);
template bool left_out(const Key<InvalidSpec>&, const InvalidSpec&);
template bool left_out(const Key<ExclusionSpec>&, const ExclusionSpec&);
template bool left_out(const Key<DesignSpec>&, const DesignSpec&);
template bool left_out(const Key<TimingSpec>&, const TimingSpec&);
template bool left_out(const Key<ResponseSpec>&, const ResponseSpec&);
template bool left_out(const Key<AdaptiveSpec>&, const AdaptiveSpec&);
template bool left_out(const Key<RunSpec>&, const RunSpec&);
template bool left_out(const Key<ObserverSpec>&, const ObserverSpec&);
template bool left_out(const Key<MaskingSpec>&, const MaskingSpec&);
template bool left_out(const Key<InstructionTexts>&, const InstructionTexts&);

template <class Record>
std::string range_of(const Key<Record>& key) {
    if (std::holds_alternative<bool Record::*>(key.member)) {
        return "true or false";
    }
    if (std::holds_alternative<std::string Record::*>(key.member)) {
        return key.text == Text::name ? "letters a-z, digits and _"
             : key.text == Text::free
                 ? "text"
                 : fmt::format("up to {} bytes, {} lines", kMostInstruction, kMostInstructionLines);
    }
    if (const auto words = words_for(key); !words.empty()) {
        std::string text;
        for (std::size_t i = 0; i < words.size(); ++i) {
            text += fmt::format("{}\"{}\"",
                                i == 0                 ? ""
                                : i + 1 < words.size() ? ", "
                                                       : " or ",
                                words[i]);
        }
        return text;
    }
    if (key.highest == kMostSeed) {
        return "0 to 9223372036854775807";
    }
    return key.above ? fmt::format("above {}, at most {}", key.lowest, key.highest)
                     : fmt::format("{} to {}", key.lowest, key.highest);
}
template std::string range_of(const Key<Protocol>&);
template std::string range_of(const Key<ApparatusSpec>&);
template std::string range_of(const Key<OutlineSpec>&);
template std::string range_of(const Key<ObjectSpec>&);
template std::string range_of(const Key<FrictionSpec>&);
template std::string range_of(const Key<SafetySpec>&);
template std::string range_of(const Key<InvalidSpec>&);
template std::string range_of(const Key<ExclusionSpec>&);
template std::string range_of(const Key<DesignSpec>&);
template std::string range_of(const Key<TimingSpec>&);
template std::string range_of(const Key<ResponseSpec>&);
template std::string range_of(const Key<AdaptiveSpec>&);
template std::string range_of(const Key<RunSpec>&);
template std::string range_of(const Key<ObserverSpec>&);
template std::string range_of(const Key<MaskingSpec>&);
template std::string range_of(const Key<InstructionTexts>&);

std::string key_reference() {
    return fmt::format("format = {}\n", kFormat) + section<Protocol>("[study]") +
           section<ApparatusSpec>("[apparatus]") + section<OutlineSpec>("[outline]") +
           section<ObjectSpec>(fmt::format("[[object]]  once each, {} to {} of them pictured",
                                           kMinPictures, kMaxPictures)) +
           object_reference() +
           section<FrictionSpec>(fmt::format("[[friction]]  once each, 1 to {}", kMaxFrictions)) +
           section<SafetySpec>(
               "[safety]  left out of the study's hash as long as all are default") +
           section<InvalidSpec>("[invalid]  left out of the hash in the same way") +
           section<ExclusionSpec>(
               "[exclusion]  of participants, applied by palpate summary; left out in the same "
               "way") +
           section<DesignSpec>("[design]") + section<TimingSpec>("[timing]") +
           section<ResponseSpec>("[response]  left out of the hash in the same way") +
           section<AdaptiveSpec>(
               "[procedure]  a rule that chooses by the answers, instead of [design]; beside these "
               "keys all "
               "of a procedure file\n             (palpate procedure --keys), with its tables as "
               "[procedure.model], [[procedure.staircase]], ...") +
           section<RunSpec>(fmt::format(
               "[[run]]  with [procedure]: the rule runs once for each, 1 to {}", kMaxRuns)) +
           section<ObserverSpec>("[observer]  of simulated sessions") +
           section<MaskingSpec>("[masking]  left out of the hash while there is no noise") +
           section<InstructionTexts>(
               fmt::format("[instructions.{}]  shown instead of the screen's own sentences; left "
                           "out of the hash where they are not given",
                           fmt::join(kLanguages, "], [instructions.")));
}

}  // namespace palpate::protocols
