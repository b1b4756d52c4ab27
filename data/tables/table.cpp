#include "data/tables/table.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace palpate::data {
namespace {

std::vector<std::string> parts_of(const std::string& place) {
    std::vector<std::string> parts;
    for (const auto& part : std::views::split(place, '/')) {
        parts.emplace_back(part.begin(), part.end());
    }
    return parts;
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
                return Json::array({value.low, value.high});
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

std::vector<Column> heads(std::initializer_list<std::string_view> all) {
    std::vector<Column> columns;
    for (const std::string_view text : all) {
        const std::size_t first = std::min(text.find('|'), text.size());
        const std::size_t second = std::min(text.find('|', first + 1), text.size());
        const std::string_view key = text.substr(0, first);
        const bool same = first == text.size();
        Column& column = columns.emplace_back();
        column.key = key;
        column.words = same ? key : text.substr(first + 1, second - first - 1);
        for (const char mark : text.substr(second)) {
            column.digits = mark >= '0' && mark <= '9' ? mark - '0' : column.digits;
            column.says = mark == 'p' ? Column::Says::p
                        : mark == 's' ? Column::Says::significant
                                      : column.says;
            column.open = column.open || mark == 'o';
            column.on_page = column.on_page && mark != '-';
        }
    }
    return columns;
}

Cell cell_of(double value, std::string why) {
    return std::isfinite(value) ? Cell(value) : Cell(Nothing{std::move(why)});
}

Cell cell_of(const std::optional<double>& value, std::string why) {
    return value ? cell_of(*value, std::move(why)) : Cell(Nothing{std::move(why)});
}

Cell cell_of(const std::optional<Interval>& value, std::string why) {
    return value ? Cell(*value) : Cell(Nothing{std::move(why)});
}

Cell cell_of(std::size_t count) {
    return static_cast<std::int64_t>(count);
}

OverPeople over_people(std::string what, std::span<const Score> all, bool test, bool ratio) {
    OverPeople made{.what = std::move(what), .ratio = ratio};
    std::vector<double> known;
    std::vector<double> ranks;
    for (const Score& one : all) {
        if (std::isfinite(one.value)) {
            known.push_back(one.value);
        } else {
            made.left_out.push_back({one.name, one.why});
        }
        if (!std::isnan(one.rank)) {
            ranks.push_back(one.rank);
        }
    }
    made.mean = known.empty() ? PeopleMean{.mean = std::nan("")} : mean_over_people(known);
    if (ranks.size() == all.size()) {
        made.median = median_of(ranks);
    }
    if (test && known.size() > 1) {
        made.test = sign_flip(known);
    }
    return made;
}

Table over_people_table(std::string place, std::span<const OverPeople> all) {
    Table table{
        .place = std::move(place),
        .title = "  Over people (mean, of ratios the geometric one, Student's interval of 95 %)",
        .columns = heads({"what", "people", "mean|mean|s", "interval_95|interval|s",
                          "sign_flip_p|sign-flip p|p", "median|median, unbounded by rank|s",
                          "geometric||-", "left_out||-"})};
    if (std::ranges::any_of(all,
                            [](const OverPeople& one) { return one.test && !one.test->exact; })) {
        table.notes.emplace_back("p of sign-flip: of patterns drawn by chance, not of all.");
    }
    for (const OverPeople& one : all) {
        const auto shown = [&](double value) {
            return one.ratio ? std::exp(value) : value;
        };
        std::optional<Interval> ends = one.mean.interval;
        if (ends) {
            ends = Interval{shown(ends->low), shown(ends->high)};
        }
        std::vector<std::string> left_out;
        for (const LeftOutPerson& person : one.left_out) {
            left_out.push_back(fmt::format("{} ({})", person.name, person.why));
        }
        if (!left_out.empty()) {
            table.notes.push_back(fmt::format("{}: {}", one.what, without_text(one.left_out)));
        }
        table.rows.push_back({one.what, cell_of(one.mean.people), cell_of(shown(one.mean.mean)),
                              cell_of(ends), one.test ? Cell(one.test->p) : Cell(Nothing{}),
                              one.median ? cell_of(shown(*one.median)) : Cell(Nothing{}), one.ratio,
                              std::move(left_out)});
    }
    return table;
}

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
