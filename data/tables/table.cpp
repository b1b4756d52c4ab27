#include "data/tables/table.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data/csv/csv_text.hpp"

namespace palpate::data {
namespace {

/// In the fewest digits that read back to the same bits, inf too; empty for what is no number.
std::string all_digits(double value) {
    return std::isnan(value) ? "" : fmt::format("{}", value);
}

std::string field_of(const Cell& cell) {
    if (const auto* named = std::get_if<Named>(&cell)) {
        return named->shown;
    }
    if (const auto* text = std::get_if<std::string>(&cell)) {
        return *text;
    }
    if (const auto* yes = std::get_if<bool>(&cell)) {
        return *yes ? "yes" : "no";
    }
    if (const auto* count = std::get_if<std::int64_t>(&cell)) {
        return fmt::format("{}", *count);
    }
    if (const auto* number = std::get_if<double>(&cell)) {
        return all_digits(*number);
    }
    const auto* list = std::get_if<std::vector<std::string>>(&cell);
    return list != nullptr ? fmt::format("{}", fmt::join(*list, ", ")) : std::string();
}

bool any_interval(const Table& table, std::size_t column) {
    for (const auto& row : table.rows) {
        if (std::holds_alternative<Interval>(row[column])) {
            return true;
        }
    }
    return false;
}

/// "interval_95" is said as low and high, "wilson_95" as wilson_low and wilson_high.
std::string end_name(const std::string& key, const char* end) {
    const std::string name = key.substr(0, key.find_last_of('_'));
    return name == "interval" ? end : name + "_" + end;
}

std::vector<std::string> parts_of(const std::string& place) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= place.size();) {
        const std::size_t end = std::min(place.find('/', at), place.size());
        parts.push_back(place.substr(at, end - at));
        at = end + 1;
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

Fields fields_of(const Table& table) {
    Fields fields{.names = {}, .rows = {table.rows.size(), std::vector<std::string>()}};
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const Column& column = table.columns[i];
        if (!column.on_page || column.key.empty()) {
            continue;
        }
        const bool ends = any_interval(table, i);
        if (ends) {
            fields.names.push_back(end_name(column.key, "low"));
            fields.names.push_back(end_name(column.key, "high"));
        } else {
            fields.names.push_back(column.key.substr(column.key.find('/') + 1));
        }
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            const Cell& cell = table.rows[row][i];
            if (ends) {
                const auto* both = std::get_if<Interval>(&cell);
                fields.rows[row].push_back(both != nullptr ? all_digits(both->low) : "");
                fields.rows[row].push_back(both != nullptr ? all_digits(both->high) : "");
            } else {
                fields.rows[row].push_back(field_of(cell));
            }
        }
    }
    return fields;
}

std::string table_csv(const Fields& fields) {
    std::string csv = fmt::format("{}\n", fmt::join(fields.names, ","));
    for (const auto& row : fields.rows) {
        for (const std::string& field : row) {
            csv += &field == &row.front() ? "" : ",";
            csv += field.empty() ? field : csv_field(field);
        }
        csv += '\n';
    }
    return csv;
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
