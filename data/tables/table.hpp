#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "data/csv/json_text.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/paired.hpp"

/// What an analysis found, made once and said as text, JSON, CSV and on the page: these cannot
/// differ.
namespace palpate::data {

/// No value, and why there is none where that is not plain.
struct Nothing {
    std::string why{};
};
/// What programs and what people call the same thing.
struct Named {
    std::string key{};
    std::string shown{};
};
using Cell = std::variant<Nothing,
                          Named,
                          std::string,
                          bool,
                          std::int64_t,
                          double,
                          Interval,
                          std::vector<std::string>>;

/// Of a number that is not finite, too: nothing.
[[nodiscard]] Cell cell_of(double value, std::string why = {});
[[nodiscard]] Cell cell_of(const std::optional<double>& value, std::string why = {});
[[nodiscard]] Cell cell_of(const std::optional<Interval>& value, std::string why = {});
[[nodiscard]] Cell cell_of(std::size_t count);

struct Column {
    /// p: "<0.001" below that; significant: four digits, or more where the row's first interval,
    /// so narrow, needs them.
    enum class Says : std::uint8_t { number, p, significant };
    std::string key{};    ///< in JSON, CSV and on the page; "bits/null_p": within "bits" in JSON;
                          ///< empty: text alone
    std::string words{};  ///< above it in text; empty: text does not say it
    int digits = 3;       ///< of numbers in text, after the point; JSON, CSV and page have all
    Says says = Says::number;
    bool on_page = true;
    bool open =
        false;  ///< JSON says of an interval "low", "high" or "both" where an end is infinite
};

/// Columns as "key|words|marks", one a text: "key" alone has words that are the same, "key|" none.
/// Marks: a digit says `digits`, p and s what Says begins with, o `open`, - that the page is
/// without.
[[nodiscard]] std::vector<Column> heads(std::initializer_list<std::string_view> all);

/// Rows that the first `index` columns name.
struct Table {
    std::string place{};  ///< in JSON: "measures/*/means/*", a star for each column of the index;
                          ///< a last "-": a list of the rows. Empty: nowhere
    std::string title{};  ///< above it in text, lines; on the page its caption
    std::vector<Column> columns{};
    std::size_t index = 1;
    bool across = false;  ///< in text a row stands as a column
    std::vector<std::vector<Cell>> rows{};
    std::vector<std::string> notes{};  ///< below it in text
};

/// Title, heads, rows and notes, indented by two; in place of no value stands the reason or "-",
/// and a column without any is left out. Empty where there is no row.
[[nodiscard]] std::string table_text(const Table& table);

/// Writes the rows to their place in `all`: what has no value is null, and "why" of the row says
/// the reasons; so is an end of an interval that is infinite (profile_95: profile_open).
void put_table(Json& all, const Table& table);

/// Rows of fields, numbers in the fewest digits that read back to the same bits, an interval as two
/// columns (low, high; inf where nothing bounds it), nothing as an empty field.
struct Fields {
    std::vector<std::string> names{};
    std::vector<std::vector<std::string>> rows{};
};
[[nodiscard]] Fields fields_of(const Table& table);
/// These as CSV with a head.
[[nodiscard]] std::string table_csv(const Fields& fields);

/// A number a person, over people: of those in whom it has an end.
struct OverPeople {
    std::string what{};
    PeopleMean mean{};               ///< of nobody: NaN; of a logarithm where `ratio` says so
    bool ratio = false;              ///< said as a geometric mean
    std::optional<double> median{};  ///< of everybody, what is unbounded by its rank
    std::optional<SignFlip> test{};  ///< of a difference or the logarithm of a ratio
    std::vector<LeftOutPerson> left_out{};
};

/// What one person has to say of it.
struct Score {
    double value = std::numeric_limits<double>::quiet_NaN();  ///< not finite: `why`
    double rank =
        std::numeric_limits<double>::quiet_NaN();  ///< infinite: unbounded; NaN: not known
    std::string why{};
    std::string name{};  ///< of the person
};
/// @param test  of no difference
[[nodiscard]] OverPeople over_people(std::string what,
                                     std::span<const Score> all,
                                     bool test,
                                     bool ratio = false);

/// A row a number; who is left out stands below.
[[nodiscard]] Table over_people_table(std::string place, std::span<const OverPeople> all);

}  // namespace palpate::data
