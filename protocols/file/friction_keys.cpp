#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "engine/friction/laws/law.hpp"
#include "protocols/file/keys.hpp"

namespace palpate::protocols {
namespace {

/// Whether it is the number of the key, whatever its unit.
bool is_number_of(std::string_view key, std::string_view number) {
    return !number.empty() && key.starts_with(number) &&
           (key.size() == number.size() || key[number.size()] == '_');
}

std::vector<LawKeys> all_law_keys() {
    std::vector<LawKeys> all{{.law = "frictionless", .rubs = false, .sticks = false},
                             {.law = "gos", .relaxes = true},
                             {.law = "coulomb", .sticks = false}};
    for (const engine::LawTraits* const own : engine::all_laws()) {
        all.push_back({.law = own->word, .sticks = own->sticks, .own = own});
    }
    return all;
}

}  // namespace

bool LawKeys::needs(std::string_view key) const {
    return (rubs && key == "mu_d") || (sticks && key == "mu_s") ||
           (own != nullptr && own->needs_first && is_number_of(key, own->reads.front()));
}

bool LawKeys::reads(const Key& key) const {
    const bool by_law = key.need == Need::by_law || key.need == Need::by_law_optional;
    return !by_law || needs(key.name) || (relaxes && key.name.starts_with("tau_")) ||
           (own != nullptr && std::ranges::any_of(own->reads, [&](std::string_view number) {
                return is_number_of(key.name, number);
            }));
}

bool LawKeys::check(Keys keys,
                    const std::string& path,
                    const Places& places,
                    Problems& problems) const {
    bool right = true;
    const auto wrong = [&](const std::string& at, std::string what) {
        problems.add(places.of(at), std::move(what));
        right = false;
    };
    for (const Key& key : keys) {
        const std::string at = fmt::format("{}.{}", path, key.name);
        if (needs(key.name) && !places.has(at)) {
            wrong(path, fmt::format("law \"{}\" needs the key {}: add it ({}; {})", law, key.name,
                                    range_of(key), key.meaning));
        } else if (!reads(key) && places.has(at)) {
            wrong(at, fmt::format("{} is given, but law is \"{}\", which does not read it: "
                                  "delete it, or give another law",
                                  key.name, law));
        }
    }
    return right;
}

std::span<const LawKeys> friction_laws() {
    static const std::vector<LawKeys> kAll = all_law_keys();
    return kAll;
}

const LawKeys* keys_of_law(std::string_view law) {
    const auto all = friction_laws();
    const auto found = std::ranges::find(all, law, &LawKeys::law);
    return found == all.end() ? nullptr : &*found;
}

std::string wrong_law(std::string_view law, WordList more) {
    std::vector<std::string_view> words;
    for (const LawKeys& one : friction_laws()) {
        words.push_back(one.law);
    }
    if (more.empty()) {  // no protocol may have it
        std::erase(words, "lugre_euler");
    }
    words.insert(words.end(), more.begin(), more.end());
    return fmt::format("law is {}, give one of {}{}", shown(std::string(law)),
                       fmt::join(words, ", "), suggestion(law, words, ""));
}

}  // namespace palpate::protocols
