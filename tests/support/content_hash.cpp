#include "tests/support/content_hash.hpp"

#include <vector>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "data/store/reader.hpp"

namespace palpate::tests {
namespace {

/// The hash of hashes: each row's text is hashed, the sum hashes the list.
class Content {
public:
    void line(const std::string& text) { all_ += sha256_hex(text) + '\n'; }
    [[nodiscard]] std::string hash() const { return sha256_hex(all_); }

private:
    std::string all_;
};

std::vector<std::string> tables(data::Database& database) {
    return texts(database.prepare(
        "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%' AND name "
        "NOT IN ('session_provenance', 'trace_chunk', 'secret') ORDER BY name"));
}

/// From run to run, though nothing else differs.
bool varies(std::string_view column) {
    return column.ends_with("_utc") || column == "at_ns" || column == "started_ns" ||
           column == "uuid" || column == "seal" || column == "newest_seal";
}

void add_table(data::Database& database, const std::string& table, Content& content) {
    // The first two columns are a key in every table, or begin with one.
    for (const data::Statement& row :
         database.prepare(fmt::format("SELECT * FROM {} ORDER BY 1, 2", table))) {
        std::string text = table + ':';
        for (int column = 0; column < row.columns(); ++column) {
            if (!varies(row.name(column))) {
                const std::string value =
                    row.type(column) == 2 ? fmt::format("{}", row.real(column)) : row.text(column);
                text += fmt::format("{}:{}:{};", row.type(column), value.size(), value);
            }
        }
        content.line(text);
    }
}

/// Columns one after the other, bytes shuffled within each.
std::string shuffled_columns(std::span<const engine::TickRecord> ticks) {
    std::string raw;
    for (const data::TraceColumn& column : data::trace_columns()) {
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            for (const engine::TickRecord& tick : ticks) {
                raw += reinterpret_cast<const char*>(&tick)[column.offset + byte];
            }
        }
    }
    return raw;
}

void add_traces(data::Database& database, Content& content) {
    std::vector<std::pair<std::int64_t, std::int64_t>> intervals;
    for (const data::Statement& row :
         database.prepare("SELECT trial_id, interval FROM presentation ORDER BY 1, 2")) {
        intervals.emplace_back(row.integer(0), row.integer(1));
    }
    data::TraceReader traces(database);
    for (const auto& [trial, interval] : intervals) {
        content.line(fmt::format("trace {} {} ", trial, interval) +
                     shuffled_columns(traces.stored(trial, interval)));
    }
}

}  // namespace

std::string content_hash(data::Database& database) {
    const data::Snapshot now(database);
    Content content;
    for (const std::string& table : tables(database)) {
        add_table(database, table, content);
    }
    add_traces(database, content);
    return content.hash();
}

}  // namespace palpate::tests
