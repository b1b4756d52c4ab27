#include "data/store/own_schema.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <ranges>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sqlite3.h>

#include "engine/base/files.hpp"
#include "data/schema/catalogue.hpp"

namespace palpate::data {
namespace {

using Of = SchemaDifference::Of;

struct Entry {
    std::string of;  ///< the table that it belongs to
    std::string sql;
};
using Schema = std::map<std::pair<std::string, std::string>, Entry>;  // by type and name

/// SQLite's own list of what a database holds. A table of the file can be called sqlite_schema,
/// none sqlite_master.
Schema read_schema(const Connection& file) {
    Schema all;
    Statement row(file, "SELECT type, name, lower(tbl_name), sql FROM main.sqlite_master");
    while (row.step()) {
        const std::string sql = row.null(3) ? "of " + row.text(2) : row.text(3);
        all[{row.text(0), row.text(1)}] = {row.text(2), sql};
    }
    return all;
}

/// What a file holds that this palpate makes.
const Schema& own_schema() {
    static const Schema own = [] {
        Connection made{.file = "the catalogue"};
        if (sqlite3_open(":memory:", &made.handle) != SQLITE_OK) {
            made.fail("opening");
        }
        made.execute(std::string(schema_sql()).c_str());
        Schema all = read_schema(made);
        made.forget_idle();
        sqlite3_close(made.handle);
        return all;
    }();
    return own;
}

bool is_ours(std::string_view table) {
    return std::ranges::any_of(own_schema(), [table](const auto& entry) {
        return entry.first.second == table && entry.first.first != "index";
    });
}

std::string lower(std::string text) {
    for (char& c : text) {
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return text;
}

/// What another program compares by is not here, and without it SQLite changes no row.
bool sorts_as_sqlite(std::string_view index) {
    std::istringstream words{lower(std::string(index))};
    bool collate = false;
    for (std::string word; words >> word; collate = word == "collate") {
        const std::string rule = word.substr(0, word.find_first_of(",)"));
        if (collate && rule != "nocase" && rule != "binary" && rule != "rtrim") {
            return false;
        }
    }
    return true;
}

/// An index of names alone decides nothing: UNIQUE refuses rows, WHERE and expressions can fail.
bool is_plain(std::string_view index) {
    constexpr std::string_view kBegin = "CREATE INDEX ";
    static constexpr std::string_view kBlanks = " \n\r\t";
    index = index.substr(0, index.find_last_not_of(kBlanks) + 1);
    const std::size_t columns = std::min(index.find('('), index.size());
    const auto names = [](std::string_view text, std::string_view more) {
        return std::ranges::all_of(text, [more](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                   kBlanks.find(c) != std::string_view::npos ||
                   more.find(c) != std::string_view::npos;
        });
    };
    return index.starts_with(kBegin) && names(index.substr(0, columns), "_\"-.") &&
           names(index.substr(columns), "_,()\"") && sorts_as_sqlite(index) &&
           std::ranges::count(index, '(') == 1 && index.ends_with(')');
}

Of kind_of(std::string_view type) {
    return type == "table" ? Of::table : type == "view" ? Of::view : Of::index;
}

/// Something of ours that is another, or not there.
void compare_ours(const Schema& stored, std::vector<SchemaDifference>& found) {
    for (const auto& [object, entry] : own_schema()) {
        const auto there = stored.find(object);
        if (there != stored.end() && there->second.sql == entry.sql) {
            continue;
        }
        const std::string other = object.first == "table" ? "view" : "table";
        found.push_back({.of = kind_of(object.first),
                         .name = object.first + ' ' + object.second,
                         .stored = there != stored.end()                   ? there->second.sql
                                 : stored.contains({other, object.second}) ? "it is a " + other
                                                                           : "it is not there",
                         .wanted = "as this palpate makes it"});
    }
}

/// Something of somebody else's that stands in our way.
void compare_theirs(const Schema& stored, std::vector<SchemaDifference>& found) {
    for (const auto& [object, entry] : stored) {
        const auto& [type, name] = object;
        const bool on_ours = is_ours(entry.of) && !own_schema().contains(object);
        if (type == "trigger" && on_ours) {
            found.push_back(
                {.of = Of::trigger,
                 .name = "trigger " + name,
                 .stored = "it is there",
                 .wanted = fmt::format("no trigger on {}: what was written since may be its doing",
                                       entry.of)});
        } else if (type == "index" && on_ours && !is_plain(entry.sql)) {
            found.push_back({.of = Of::index,
                             .name = "index " + name,
                             .stored = entry.sql,
                             .wanted = fmt::format("none that decides what {} takes", entry.of)});
        }
    }
}

/// "view analysis_trial, trigger t"
std::string names_of(const std::vector<SchemaDifference>& differences) {
    const auto names = std::views::transform(differences, &SchemaDifference::name);
    return fmt::format("{}", fmt::join(names, ", "));
}

/// A table of somebody's that refers to ours by what is no key: SQLite refuses every change of ours
/// for it.
bool refers_badly(const Connection& file, const std::string& table) {
    bool to_ours = false;
    for (Statement row(file, fmt::format("PRAGMA foreign_key_list({})", quoted_name(table)));
         row.step();) {
        to_ours = to_ours || is_ours(lower(row.text(2)));
    }
    try {
        if (to_ours) {  // refused before it looks at a row
            const Statement asked(file,
                                  fmt::format("PRAGMA foreign_key_check({})", quoted_name(table)));
        }
        return false;
    } catch (const StoreError&) {
        return true;
    }
}

void compare_references(const Connection& file,
                        const Schema& stored,
                        std::vector<SchemaDifference>& found) {
    for (const auto& [object, entry] : stored) {
        if (object.first == "table" && !own_schema().contains(object) &&
            lower(entry.sql).find("references") != std::string::npos &&
            refers_badly(file, object.second)) {
            found.push_back({.of = Of::index,
                             .name = "table " + object.second,
                             .stored = "it refers to ours by columns that are no key",
                             .wanted = "a reference to a key, or none"});
        }
    }
}

}  // namespace

std::vector<SchemaDifference> schema_differences(const Connection& file) {
    const Schema stored = read_schema(file);
    std::vector<SchemaDifference> found;
    compare_ours(stored, found);
    compare_theirs(stored, found);
    compare_references(file, stored, found);
    std::ranges::stable_sort(found, {}, &SchemaDifference::of);
    return found;
}

std::string ordered_elsewhere(const Connection& file) {
    std::string all;
    for (const auto& [object, entry] : read_schema(file)) {
        if (!own_schema().contains(object) && !sorts_as_sqlite(entry.sql)) {
            all += (all.empty() ? "" : ", ") + object.first + ' ' + object.second;
        }
    }
    return all;
}

std::string referring_tables(const Connection& file) {
    std::string all;
    for (const auto& [object, entry] : read_schema(file)) {
        if (object.first == "table" && !own_schema().contains(object) &&
            lower(entry.sql).find("references") != std::string::npos) {
            all += (all.empty() ? "" : ", ") + object.second;
        }
    }
    return all;
}

void refuse_schema(const Connection& file,
                   const std::vector<SchemaDifference>& differences,
                   std::string_view so) {
    throw WrongFile(fmt::format(
        "{}: its schema is not as this palpate makes it, and {}: {}; drop what was added, take a "
        "copy made before, or choose another file name. palpate verify says what differs",
        file.file, so, names_of(differences)));
}

void remark_schema(const Connection& file, const std::vector<SchemaDifference>& differences) {
    const bool views = std::ranges::any_of(differences, [](const SchemaDifference& one) {
        return one.of == Of::view || one.of == Of::table;
    });
    remark(fmt::format(
        "{}: its schema is not as this palpate makes it: {}; {}palpate verify says what differs",
        file.file, names_of(differences),
        views ? "palpate's own views are used, and none of the file; " : ""));
}

void make_own_views(const Connection& file) {
    std::string sql(views_sql());
    constexpr std::string_view kMade = "CREATE VIEW ";
    constexpr std::string_view kTemporary = "CREATE TEMP VIEW IF NOT EXISTS ";
    for (std::size_t at = sql.find(kMade); at != std::string::npos;
         at = sql.find(kMade, at + kTemporary.size())) {
        sql.replace(at, kMade.size(), kTemporary);
    }
    file.execute(sql.c_str());
}

}  // namespace palpate::data
