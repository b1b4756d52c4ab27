#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/row.hpp"
#include "data/verify/finding.hpp"
#include "data/verify/stored_row.hpp"

namespace palpate::data {

/// Takes down what is found, for the trial that is being looked at.
class Findings {
public:
    /// @param all  gets what is found; outlives this
    explicit Findings(std::vector<Finding>& all) : all_(all) {}

    /// Findings from here on are of this trial; none: of the session or the file.
    void look_at(std::optional<std::int64_t> trial) { trial_ = trial; }
    /// Adds a finding: what the file says and what follows, or why nothing can be compared.
    void differs(std::string_view what, std::string stored, std::string recomputed);
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
    [[nodiscard]] std::size_t size() const noexcept { return all_.size(); }

private:
    std::vector<Finding>& all_;
    std::optional<std::int64_t> trial_;
};

}  // namespace palpate::data
