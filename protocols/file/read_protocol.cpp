#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/file/document.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/object_tables.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/file/rules.hpp"

namespace palpate::protocols {
namespace {

constexpr std::array<std::string_view, 19> kTablesOfProtocols{
    "format",       "study",     "apparatus", "outline",  "object",   "friction", "safety",
    "invalid",      "exclusion", "design",    "timing",   "response", "observer", "masking",
    "instructions", "procedure", "run",       "analysis", "surface"};

/// Stage 2: keys, types and ranges.
class Stage {
public:
    Stage(const Table& file, Problems& problems, Places& places)
        : file_(file),
          problems_(problems),
          places_(places),
          top_(file, "", {}, problems, places, "the file") {}

    Protocol read() {
        Protocol protocol;
        refuse_unknown();
        top_.check_format(kFormat);
        table("study", protocol, true);
        table("apparatus", protocol.apparatus);
        table("outline", protocol.outline);
        if (top_.has("surface")) {
            table("surface", protocol.surface.emplace());
        }
        for (const TableReader& object : tables("object")) {
            read_object(object, protocol.objects);
        }
        frictions(protocol);
        table("safety", protocol.safety);
        table("invalid", protocol.invalid);
        table("exclusion", protocol.exclusion);
        table("analysis", protocol.analysis);
        design(protocol);
        table("timing", protocol.timing);
        table("response", protocol.response);
        table("observer", protocol.observer);
        table("masking", protocol.masking);
        instructions(protocol);
        return protocol;
    }

private:
    /// [design] alone, or [procedure] with [[run]] and the breaks of [design].
    void design(Protocol& protocol) {
        const Entry* procedure = find("procedure");
        table("design", protocol.design, procedure == nullptr);
        if (procedure != nullptr) {
            breaks_alone(procedure->at);
            read_adaptive(*procedure, problems_, places_, protocol);
            for (TableReader& run : tables("run")) {
                fill(run, protocol.runs.emplace_back());
            }
        } else {
            factorial();
        }
    }

    void refuse_unknown() {
        for (const Entry& entry : file_) {
            if (std::ranges::find(kTablesOfProtocols, entry.key) == kTablesOfProtocols.end()) {
                problems_.add(entry.at, fmt::format("unknown key or table {}{}", shown(entry.key),
                                                    suggestion(entry.key, kTablesOfProtocols)));
            }
        }
    }

    void frictions(Protocol& protocol) {
        for (TableReader& friction : tables("friction")) {
            fill(friction, protocol.frictions.emplace_back());
            law(protocol.frictions.back(), friction.path());
        }
    }

    [[nodiscard]] const Entry* find(std::string_view key) const {
        return protocols::find(file_, key);
    }

    template <class Record>
    static void fill(TableReader& table, Record& record) {
        table.read_last(keys_of<Record>(), &record);
    }

    /// Without a rule that chooses, the design has to say how often each condition comes.
    void factorial() {
        for (const Key& key : keys_of<DesignSpec>()) {
            if (key.need == Need::factorial && find("design") != nullptr &&
                !places_.has(fmt::format("design.{}", key.name))) {
                problems_.add(places_.of("design"),
                              fmt::format("[design] lacks the key {}: add it ({}; {})", key.name,
                                          range_of(key), key.meaning));
            }
        }
        if (const Entry* run = find("run")) {
            problems_.add(run->at,
                          "there are runs, but no rule for them: add the table "
                          "[procedure], or delete [[run]]");
        }
    }

    /// Where a rule chooses, it says how often, too: of the design only the breaks are left.
    void breaks_alone(const Position& procedure) {
        std::string keys;
        for (const Key& key : keys_of<DesignSpec>()) {
            if (key.name != "break_every" && places_.has(fmt::format("design.{}", key.name))) {
                keys += (keys.empty() ? "" : ", ") + std::string(key.name);
            }
        }
        if (!keys.empty()) {
            problems_.add(places_.of("design"),
                          fmt::format("[design] says {}, and the rule of [procedure] in line {} "
                                      "decides that: keep [procedure] and of [design] no more than "
                                      "break_every, or keep [design] and delete [procedure] and "
                                      "[[run]]",
                                      keys, procedure.line));
        }
    }

    template <class Record>
    void table(std::string_view name, Record& record, bool required = false) {
        if (auto found = top_.table(name)) {
            fill(*found, record);
        } else if (required && !top_.has(name)) {
            problems_.add({}, fmt::format("the table [{}] is missing: add it", name));
        }
    }

    void texts(const Entry& language, Protocol& protocol) {
        const auto known = std::ranges::find(kLanguages, language.key);
        const auto* texts = std::get_if<Table>(&language.value.data);
        if (texts == nullptr) {
            problems_.add(language.at,
                          fmt::format("{} stands in [instructions]: put it into a table of "
                                      "its language, [instructions.en]",
                                      shown(language.key)));
        } else if (known == kLanguages.end()) {
            problems_.add(language.at,
                          fmt::format("[instructions.{}]: the screen knows the languages {} "
                                      "only{}",
                                      shown(language.key), fmt::join(kLanguages, " and "),
                                      suggestion(language.key, kLanguages)));
        } else {
            const auto index = static_cast<std::size_t>(known - kLanguages.begin());
            TableReader reader = top_.of(*texts, "instructions." + language.key, language.at);
            fill(reader, protocol.instructions.at(index));
        }
    }

    /// One table a language.
    void instructions(Protocol& protocol) {
        const Entry* entry = find("instructions");
        if (entry == nullptr) {
            return;
        }
        const auto* languages = std::get_if<Table>(&entry->value.data);
        if (languages == nullptr) {
            problems_.add(entry->at, fmt::format("instructions is {}: write a table for each "
                                                 "language, [instructions.en]",
                                                 shown(entry->value)));
            return;
        }
        for (const Entry& language : *languages) {
            texts(language, protocol);
        }
    }

    std::vector<TableReader> tables(std::string_view name) {
        if (!top_.has(name)) {
            problems_.add({},
                          fmt::format("there is no [[{}]]: add one table for each {}", name, name));
        }
        return top_.tables(name);
    }

    /// Which numbers a friction needs depends on its law.
    void law(FrictionSpec& friction, const std::string& path) {
        const LawKeys* law = keys_of_law(friction.law);
        if (law == nullptr) {
            problems_.add(places_.of(path + ".law"), wrong_law(friction.law));
            return;
        }
        law->check(keys_of<FrictionSpec>(), path, places_, problems_);
        if (!law->needs("mu_s")) {
            friction.mu_s = friction.mu_d;
        }
    }

    const Table& file_;
    Problems& problems_;
    Places& places_;
    TableReader top_;
};

}  // namespace

Protocol parse_protocol(std::string_view text, std::string_view file_name) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    Places places;
    Protocol protocol = Stage(file, problems, places).read();
    problems.throw_if_any(file_name);
    check_rules(protocol, places, problems);
    problems.throw_if_any(file_name);
    return protocol;
}

Protocol stored_protocol(std::string_view text) {
    return parse_protocol(text, "study.protocol_toml");
}

}  // namespace palpate::protocols
