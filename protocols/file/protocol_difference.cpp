#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "protocols/file/protocol_file.hpp"

namespace palpate::protocols {
namespace {

using Entries = std::vector<std::pair<std::string, std::string>>;  // "friction.rough mu_d", "0.4"

/// Lines of the canonical text: a table, or a key with its whole value.
class Reader {
public:
    Entries entries;

    void take(std::string_view line) {
        const std::size_t equals = line.find(" = ");
        if (line.starts_with("[[")) {
            list_ = line.substr(2, line.find(']') - 2);
            table_ = fmt::format("{}.{}", list_, ++tables_[list_]);
        } else if (line.starts_with('[')) {
            table_ = line.substr(1, line.find(']') - 1);
            const bool inner = !name_.empty() && table_.starts_with(list_ + ".");
            table_ = inner ? name_ + table_.substr(list_.size()) : table_;
            name_ = inner ? name_ : "";
        } else if (equals != std::string_view::npos && !line.starts_with(' ')) {
            take_value(line.substr(0, equals), line.substr(equals + 3));
        } else if (!line.empty() && !entries.empty()) {  // a value of several lines
            entries.back().second += fmt::format(" {}", line);
        }
    }

private:
    void take_value(std::string_view key, std::string_view value) {
        if (key == "name" && !list_.empty() && table_.starts_with(list_ + ".")) {
            const std::string_view bare = value.size() >= 2 && value.front() == '"'
                                            ? value.substr(1, value.size() - 2)
                                            : value;
            table_ = name_ = fmt::format("{}.{}", list_, bare);
        }
        entries.emplace_back(table_.empty() ? std::string(key) : fmt::format("{} {}", table_, key),
                             value);
    }

    std::string list_;   ///< of the table that was read last, if it is one of a list
    std::string table_;  ///< as it is called
    std::string name_;   ///< of the list's table, for tables inside it
    std::map<std::string, int> tables_;
};

Entries entries_of(std::string_view text) {
    Reader reader;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        reader.take(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return std::move(reader.entries);
}

}  // namespace

std::vector<std::string> differences(std::string_view there, std::string_view here) {
    const Entries before = entries_of(there);
    const Entries now = entries_of(here);
    const auto value_in = [](const Entries& all, const std::string& key) {
        const auto found = std::ranges::find(all, key, &Entries::value_type::first);
        return found == all.end() ? std::string() : found->second;
    };
    std::vector<std::string> found;
    for (const auto& [key, value] : before) {
        const std::string other = value_in(now, key);
        if (other.empty()) {
            found.push_back(fmt::format("{} {} there, nothing here", key, value));
        } else if (other != value) {
            found.push_back(fmt::format("{} {} there, {} here", key, value, other));
        }
    }
    for (const auto& [key, value] : now) {
        if (value_in(before, key).empty()) {
            found.push_back(fmt::format("{} nothing there, {} here", key, value));
        }
    }
    return found;
}

std::string differences_text(std::string_view there, std::string_view here) {
    constexpr std::size_t kShown = 6;
    std::vector<std::string> differ = differences(there, here);
    if (differ.size() > kShown) {
        const std::string more = fmt::format("and {} more", differ.size() - kShown);
        differ.resize(kShown);
        differ.push_back(more);
    }
    return fmt::format("{}", fmt::join(differ, "; "));
}

}  // namespace palpate::protocols
