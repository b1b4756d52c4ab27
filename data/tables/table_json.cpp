#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data/tables/table.hpp"

namespace palpate::data {
namespace {

std::vector<std::string> parts_of(const std::string& place) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= place.size();) {
        const std::size_t end = std::min(place.find('/', at), place.size());
        parts.push_back(place.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

Json finite(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_of(const Cell& cell) {
    return std::visit(
        [](const auto& value) -> Json {
            using Kind = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Kind, Nothing>) {
                return nullptr;
            } else if constexpr (std::is_same_v<Kind, Named>) {
                return value.key;
            } else if constexpr (std::is_same_v<Kind, Interval>) {
                return Json::array({finite(value.low), finite(value.high)});
            } else {
                return value;
            }
        },
        cell);
}

/// Which ends are null because nothing bounds them.
Json open_ends(const Cell& cell) {
    const auto* ends = std::get_if<Interval>(&cell);
    const bool low = ends != nullptr && std::isinf(ends->low);
    const bool high = ends != nullptr && std::isinf(ends->high);
    return low && high ? Json("both") : low ? Json("low") : high ? Json("high") : Json(nullptr);
}

std::string key_of(const Cell& cell) {
    const Json key = json_of(cell);
    return key.is_string() ? key.get<std::string>() : key.dump();
}

Json& at_place(Json& row, const std::string& key) {
    Json* at = &row;
    for (const std::string& part : parts_of(key)) {
        at = &(*at)[part];
    }
    return *at;
}

/// Where the row is written.
Json& row_of(Json& all, const Table& table, const std::vector<Cell>& row) {
    Json* at = &all;
    std::size_t star = 0;
    for (const std::string& part : parts_of(table.place)) {
        if (part == "-") {
            at->push_back(Json::object());
            at = &at->back();
        } else {
            at = &(*at)[part == "*" ? key_of(row[star++]) : part];
        }
    }
    return *at;
}

}  // namespace

void put_table(Json& all, const Table& table) {
    if (table.place.empty()) {
        return;
    }
    const bool named = table.place.ends_with('*');
    for (const auto& row : table.rows) {
        Json& written = row_of(all, table, row);
        std::vector<std::string> reasons;
        for (std::size_t i = named ? table.index : 0; i < row.size(); ++i) {
            const std::string& key = table.columns[i].key;
            if (!key.empty()) {
                at_place(written, key) = json_of(row[i]);
            }
            if (table.columns[i].open) {
                at_place(written, key.substr(0, key.find_last_of('_')) + "_open") =
                    open_ends(row[i]);
            }
            const auto* none = std::get_if<Nothing>(&row[i]);
            if (none != nullptr && !none->why.empty() &&
                std::ranges::find(reasons, none->why) == reasons.end()) {
                reasons.push_back(none->why);
            }
        }
        if (!reasons.empty()) {
            written["why"] = fmt::format("{}", fmt::join(reasons, "; "));
        }
    }
}

}  // namespace palpate::data
