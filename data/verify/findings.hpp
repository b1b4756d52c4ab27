#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "data/store/database.hpp"
#include "data/store/row.hpp"

namespace palpate::data {

/// How much a finding weighs.
enum class FindingKind : std::uint8_t {
    differs,  ///< the file says something else than what follows from the rest of it
    /// Nothing to compare: an older program did not store it, or this machine cannot know it.
    missing,
};

/// One thing that a verification found.
struct Finding {
    FindingKind kind = FindingKind::differs;
    std::optional<std::int64_t> trial{};  ///< its id
    std::optional<std::int64_t> tick{};   ///< the first one, where ticks differ
    std::string what;                     ///< table.column, or a check of SQLite's
    std::string stored{};                 ///< in the file
    std::string recomputed;               ///< what it should be, or why it is not known
    std::int64_t count = 1;               ///< ticks of the trial in which this column differs
};

/// What was looked at in a session, and what was found.
struct SessionReport {
    std::int64_t id = 0;
    std::string study;
    std::string participant;
    std::int64_t number = 0;
    std::string kind;
    bool finished = false;
    std::size_t trials = 0;     ///< attempts
    std::int64_t replayed = 0;  ///< ticks computed again
    std::string head{};         ///< last of its chain of hashes; empty: it has none
    std::vector<Finding> findings{};
};

/// What a verification says about a file.
struct Verification {
    std::vector<Finding> file;  ///< of no session: SQLite's own checks, studies
    std::vector<SessionReport> sessions;

    /// Findings of one kind, in all.
    [[nodiscard]] std::size_t count(FindingKind kind) const noexcept;
};

/// A value as SQLite gave it. No value: NULL, or a column that the file does not have.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

/// Whatever columns the file's schema has, by name.
class StoredRow {
public:
    /// A later value replaces an earlier one.
    void set(std::string_view column, Value value) {
        values_.insert_or_assign(std::string(column), std::move(value));
    }
    /// No value for a column that the file does not have: as for NULL.
    [[nodiscard]] const Value& at(std::string_view column) const;
    [[nodiscard]] bool null(std::string_view column) const {
        return std::holds_alternative<std::monostate>(at(column));
    }
    /// 0 or "" for a value of another type: SQLite's own types are checked by STRICT.
    template <class T>
    [[nodiscard]] T as(std::string_view column) const {
        const T* found = std::get_if<T>(&at(column));
        return found == nullptr ? T{} : *found;
    }
    [[nodiscard]] std::int64_t integer(std::string_view column) const {
        return as<std::int64_t>(column);
    }
    [[nodiscard]] double real(std::string_view column) const { return as<double>(column); }
    [[nodiscard]] std::string text(std::string_view column) const {
        return as<std::string>(column);
    }

private:
    std::map<std::string, Value, std::less<>> values_;
};

/// @param sql  with ?1 for `id`
[[nodiscard]] std::vector<StoredRow> rows_of(Database& database,
                                             std::string_view sql,
                                             std::optional<std::int64_t> id = std::nullopt);

/// "NULL", the number as short as it can be, or the text in quotes.
[[nodiscard]] std::string to_text(const Value& value);

/// As SQLite keeps them: a NaN is NULL, -0.0 is 0.
[[nodiscard]] bool same(const Value& stored, const Value& recomputed) noexcept;

/// Takes down what is found, for the trial that is being looked at.
class Findings {
public:
    /// @param all  gets what is found; outlives this
    explicit Findings(std::vector<Finding>& all) : all_(all) {}

    /// Findings from here on are of this trial; none: of the session or the file.
    void look_at(std::optional<std::int64_t> trial) { trial_ = trial; }
    /// Adds a finding: what the file says and what follows, or why nothing can be compared.
    void differs(std::string_view what,
                 std::string stored,
                 std::string recomputed,
                 std::optional<std::int64_t> tick = {});
    void missing(std::string_view what, std::string why);
    /// table.column of `row` must be `recomputed`.
    void expect(std::string_view table,
                std::string_view column,
                const StoredRow& row,
                const Value& recomputed);
    /// Every column of `made`, a row as the program writes it, must be stored so.
    /// @param name  of the row; empty: its table  @param tick  that it is of
    void expect(const Row& made,
                const StoredRow& row,
                std::string_view name = {},
                std::optional<std::int64_t> tick = {});
    /// The same of all rows of a table, in order, and that there are as many.
    /// @param key  rows are called "plan at KEY 3", by their first column; empty: by the table
    void expect(std::string_view table,
                std::span<const Row> made,
                std::span<const StoredRow> rows,
                std::string_view key = {});
    void add(Finding finding);

private:
    std::vector<Finding>& all_;
    std::optional<std::int64_t> trial_;
};

}  // namespace palpate::data
