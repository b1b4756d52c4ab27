#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/library/shipped.hpp"

namespace palpate::protocols {
namespace {

/// Replaces the quoted value of the first line that begins with `key = "`, which has no escapes.
void replace(std::string& text, std::string_view key, std::string_view value) {
    const std::string begin = fmt::format("\n{} = \"", key);
    const std::size_t found = text.find(begin);
    const std::size_t from = found + begin.size();
    const std::size_t to = found == std::string::npos ? found : text.find('"', from);
    refuse_if<std::logic_error>(to == std::string::npos,
                                "a shipped protocol has no line {} = \"...\"", key);
    text.replace(from, to - from, value);
}

}  // namespace

std::string id_of(std::string_view name) {
    constexpr std::size_t kLongest = 64;
    std::string id;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (plain) {
            id += c;
        } else if (c >= 'A' && c <= 'Z') {
            id += static_cast<char>(c - 'A' + 'a');
        } else if (!id.empty() && id.back() != '_') {
            id += '_';
        }
    }
    id.resize(std::min(id.size(), kLongest));
    while (!id.empty() && id.back() == '_') {
        id.pop_back();
    }
    return id.empty() ? "study" : id;
}

const ShippedProtocol& shipped_protocol(std::string_view name) {
    std::vector<std::string_view> names;
    for (const ShippedProtocol& shipped : shipped_protocols()) {
        if (shipped.name == name) {
            return shipped;
        }
        names.push_back(shipped.name);
    }
    throw std::invalid_argument(
        fmt::format("no protocol \"{}\" ships with palpate: give one of {}{}", name,
                    fmt::join(names, ", "), suggestion(name, names, "")));
}

std::string new_protocol(const ShippedProtocol& from, const std::string& id) {
    std::string title = id;
    std::replace(title.begin(), title.end(), '_', ' ');
    if (title.front() >= 'a' && title.front() <= 'z') {
        title.front() = static_cast<char>(title.front() - 'a' + 'A');
    }
    std::string text = fmt::format(
                           "# Made from {} by palpate new: change what you like, then see palpate "
                           "check. What else a\n"
                           "# protocol may say: palpate new --keys.\n#\n",
                           from.name) +
                       std::string(from.text);
    replace(text, "id", id);
    replace(text, "title", title);
    return text;
}

}  // namespace palpate::protocols
