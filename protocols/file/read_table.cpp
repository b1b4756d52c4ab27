#include <algorithm>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/file/schema.hpp"

namespace palpate::protocols {
namespace {

/// "[design]", "[instructions.en]", or "[[object]] 3" for object.3.
std::string heading(const std::string& path) {
    const std::size_t dot = path.rfind('.');
    return dot == std::string::npos || path[dot + 1] < '0' || path[dot + 1] > '9'
             ? fmt::format("[{}]", path)
             : fmt::format("[[{}]] {}", path.substr(0, dot), path.substr(dot + 1));
}

}  // namespace

void Problems::add(const Position& at, std::string what) {
    found_.insert({at, std::move(what)});
}

void Problems::take(Problems&& others) {
    found_.merge(others.found_);
}

void Problems::throw_if_any(std::string_view file_name) const {
    if (none()) {
        return;
    }
    constexpr std::size_t kMax = 100;  // who sees so many mends one and looks again
    std::string text;
    std::size_t shown = 0;
    for (const auto& [at, what] : found_) {
        if (++shown > kMax) {
            text += fmt::format("\n{}:{}:{}: {} more are not listed", file_name, at.line, at.column,
                                found_.size() - kMax);
            break;
        }
        text += fmt::format("{}{}:{}:{}: {}", text.empty() ? "" : "\n", file_name, at.line,
                            at.column, what);
    }
    throw ProtocolError(text);
}

void Places::note(const std::string& path, const Position& at) {
    places_.insert_or_assign(path, at);
}

bool Places::has(const std::string& path) const {
    return places_.contains(path);
}

Position Places::of(std::string path) const {
    for (;;) {
        if (const auto found = places_.find(path); found != places_.end()) {
            return found->second;
        }
        const std::size_t dot = path.rfind('.');
        if (dot == std::string::npos) {
            return {};
        }
        path.resize(dot);
    }
}

const Entry* find(const Table& table, std::string_view key) {
    const auto found = std::find_if(table.begin(), table.end(),
                                    [key](const Entry& entry) { return entry.key == key; });
    return found == table.end() ? nullptr : &*found;
}

Position spoken_of(const Table& table, std::string_view sentence, const Position& otherwise) {
    const Entry* entry = find(table, sentence.substr(0, sentence.find_first_of(" [")));
    return entry == nullptr ? otherwise : entry->value.at;
}

TableReader::TableReader(const Table& table,
                         std::string path,
                         const Position& at,
                         Problems& problems,
                         Places& places,
                         std::string name)
    : table_(&table),
      path_(std::move(path)),
      at_(at),
      problems_(&problems),
      places_(&places),
      name_(name.empty() ? heading(path_) : std::move(name)) {
    places_->note(path_, at_);
}

void TableReader::read(Keys keys, void* record, bool complete) {
    for (const Key& key : keys) {
        known_.push_back(key.name);
        const Entry* entry = find(*table_, key.name);
        if (entry != nullptr) {
            places_->note(fmt::format("{}.{}", path_, key.name), entry->value.at);
            read_value(key, entry->value, key.slot(record), *this);
        } else if (complete && key.need == Need::required) {
            add(at_, fmt::format("{} lacks the key {}: add it ({}; {})", name_, key.name,
                                 range_of(key), meaning_of(key)));
        }
    }
}

void TableReader::know(WordList keys) {
    known_.insert(known_.end(), keys.begin(), keys.end());
}

void TableReader::refuse_unknown() {
    for (const Entry& entry : *table_) {
        if (std::find(known_.begin(), known_.end(), entry.key) == known_.end()) {
            add(entry.at, fmt::format("unknown key {} in {}{}", shown(entry.key), name_,
                                      suggestion(entry.key, known_)));
        }
    }
}

void TableReader::check_format(std::int64_t wanted) {
    known_.push_back("format");
    const Entry* entry = find(*table_, "format");
    const auto* version =
        entry == nullptr ? nullptr : std::get_if<std::int64_t>(&entry->value.data);
    if (entry == nullptr) {
        add({}, fmt::format("the file does not say its format: begin it with format = {}", wanted));
    } else if (version == nullptr) {
        add(entry->value.at, fmt::format("format is {} ({}): give the integer, format = {}",
                                         shown(entry->value), kind_of(entry->value), wanted));
    } else if (*version != wanted) {
        add(entry->value.at, fmt::format("format is {}: this program reads format = {}",
                                         shown(entry->value), wanted));
    }
}

std::optional<TableReader> TableReader::table(std::string_view key) {
    known_.push_back(key);
    const Entry* entry = find(*table_, key);
    if (entry == nullptr) {
        return std::nullopt;
    }
    const std::string path = path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
    const auto* table = std::get_if<Table>(&entry->value.data);
    if (table == nullptr) {
        add(entry->at,
            fmt::format("{} is {}: write it as a table, [{}]", key, shown(entry->value), key));
        return std::nullopt;
    }
    return of(*table, path, entry->at,
              path_.empty() ? std::string() : fmt::format("[{}] of {}", key, name_));
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
    std::vector<TableReader> readers;
    known_.push_back(key);
    const Entry* entry = find(*table_, key);
    if (entry == nullptr) {
        return readers;
    }
    const auto* array = std::get_if<Array>(&entry->value.data);
    if (array == nullptr) {
        add(entry->at, fmt::format("{} is {}: write each {} as a table [[{}]], with two brackets",
                                   key, shown(entry->value), key, key));
        return readers;
    }
    places_->note(std::string(key), entry->value.at);
    for (std::size_t i = 0; i < array->size(); ++i) {
        const Value& value = (*array)[i];
        if (const auto* table = std::get_if<Table>(&value.data)) {
            readers.push_back(of(*table, fmt::format("{}.{}", key, readers.size() + 1), value.at));
        } else {
            add(value.at, fmt::format("{} {} is {}: write it as a table [[{}]]", key, i + 1,
                                      shown(value), key));
        }
    }
    return readers;
}

void TableReader::refuse(std::string_view key, std::string what) {
    const Entry* entry = find(*table_, key);
    add(entry == nullptr ? at_ : entry->value.at, std::move(what));
}

void TableReader::add(const Position& at, std::string what) {
    broken_ = true;
    problems_->add(at, std::move(what));
}

}  // namespace palpate::protocols
