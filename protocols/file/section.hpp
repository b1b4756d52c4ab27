#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/file/procedure_keys.hpp"
#include "protocols/procedure/grid.hpp"

/// Private to protocols/format: one table of a procedure file, read by the rows of procedure_keys().
namespace palpate::protocols {

class Section {
public:
    /// @param key    the table's key in the rows: "quest"
    /// @param shown  what messages call it: "[quest]"
    Section(const Table& table,
            std::string_view key,
            std::string shown,
            const Position& at,
            Problems& problems)
        : table_(&table),
          key_(key),
          at_(at),
          problems_(&problems),
          view_(table, shown, at, problems),
          shown_(std::move(shown)) {}

    // Each takes its range and its default from the key's row.
    [[nodiscard]] double number(std::string_view name);
    [[nodiscard]] std::optional<double> number_if(std::string_view name);
    [[nodiscard]] std::size_t count(
        std::string_view name);  ///< 0 if it is left out without a default
    [[nodiscard]] std::uint64_t seed(std::string_view name);
    [[nodiscard]] bool flag(std::string_view name);
    [[nodiscard]] std::size_t word(std::string_view name);
    [[nodiscard]] std::string text(std::string_view name);
    [[nodiscard]] std::vector<std::string> names(std::string_view name);
    [[nodiscard]] std::vector<double> numbers(std::string_view name);  ///< one or more
    [[nodiscard]] Axis axis(std::string_view name);
    /// Weights of the values of `axis`; none if left out.
    [[nodiscard]] std::vector<double> prior(const Axis& axis);

    [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
    [[nodiscard]] bool broken() const { return broken_ || view_.broken(); }
    void refuse(std::string_view name, std::string what);
    /// Every key that is not among `known` is a problem.
    void refuse_unknown(std::span<const std::string_view> known);
    /// Every key without a row is a problem.
    void refuse_unknown();
    /// As TableView::attempt().
    template <class Make>
    void attempt(Make&& make) {
        if (!broken()) {
            view_.attempt(make);
        }
    }
    [[nodiscard]] const Position& at() const noexcept { return at_; }

private:
    [[nodiscard]] const Entry* find(std::string_view name) const;
    [[nodiscard]] const ProcedureKey& row(std::string_view name) const;
    void wrong_kind(const Entry& entry, std::string_view wanted);
    [[nodiscard]] std::vector<double> spread(const Entry& entry, const Table& table);
    void check_range(const Entry& entry, const std::vector<double>& values, const Range& range);

    const Table* table_;
    std::string_view key_;
    Position at_;
    Problems* problems_;
    TableView view_;
    std::string shown_;
    bool broken_ = false;
};

}  // namespace palpate::protocols
