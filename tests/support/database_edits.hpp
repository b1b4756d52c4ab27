#pragma once

#include "data/store/reader.hpp"
#include "data/trace/chunk.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

/// Seeded edits of a database, value by value, for tests that must notice them.
namespace palpate::tests {

/// Undoes whatever is done until its end.
class Undone {
public:
    explicit Undone(data::Database& database) : database_(database) { database.execute("BEGIN"); }
    Undone(const Undone&) = delete;
    Undone& operator=(const Undone&) = delete;
    ~Undone() { database_.execute("ROLLBACK"); }

private:
    data::Database& database_;
};

/// What `sql` changes, undone at the end, is reported.
inline void check_seen(data::Database& database, const std::string& sql) {
    const Undone undone(database);
    database.execute(sql.c_str());
    const data::Verification found = data::verify(database);
    CAPTURE(sql, text_of(found));
    CHECK(found.count(data::FindingKind::differs) > 0);
}

/// Columns that nothing else in the file says (data/verify/verify.hpp).
inline const std::set<std::string> kSilent{
    "participant.handedness",  "participant.consent",      "participant.handedness_utc",
    "participant.consent_utc", "participant.refusals_utc", "participant.destroyed_utc"};

inline Words result_columns(data::Database& database, const Words& tables) {
    Words columns;
    for (const std::string& table : tables) {
        for (const auto& row : database.prepare("SELECT name FROM pragma_table_info(?1)", table)) {
            if (const std::string name = table + '.' + row.text(0); !kSilent.contains(name)) {
                columns.push_back(name);
            }
        }
    }
    return columns;
}

/// Which words the schema lets `column` have: of its CHECK (column IN ('a', 'b')); else none.
inline Words words_of(data::Database& database,
                      const std::string& table,
                      const std::string& column) {
    const std::string sql =
        database.first("SELECT sql FROM sqlite_master WHERE name = ?1", table).text(0);
    Words words;
    const std::size_t check = sql.find('(' + column + " IN");
    std::size_t at = check == std::string::npos ? check : sql.find('\'', check);
    for (const std::size_t end = sql.find(')', at); at < end;) {
        const std::size_t close = sql.find('\'', at + 1);
        words.push_back(sql.substr(at + 1, close - at - 1));
        at = sql.find('\'', close + 1);
    }
    return words;
}

/// A value with one bit or one letter of `row`'s `column` changed, or one where there was none.
inline void edit(data::Database& database,
                 const std::string& table,
                 const std::string& column,
                 std::int64_t row,
                 Random& random) {
    auto old =
        database.prepare(fmt::format("SELECT {0}, (SELECT type FROM pragma_table_info('{1}') WHERE "
                                     "name = '{0}') FROM {1} WHERE rowid = ?1",
                                     column, table),
                         row);
    REQUIRE(old.step());
    auto change =
        database.prepare(fmt::format("UPDATE {} SET {} = ?1 WHERE rowid = ?2", table, column));
    change.bind(2, row);
    if (old.null(0)) {
        old.text(1) == "TEXT" ? change.bind(1, std::string_view("late"))
                              : change.bind(1, std::int64_t{1});
    } else if (old.type(0) == 1) {
        const int which = random.below(4);  // 1 and 2, 0 and 1, or any bit
        change.bind(1, which == 0   ? 3 - old.integer(0)
                       : which == 1 ? 1 - old.integer(0)
                                    : old.integer(0) ^ (std::int64_t{1} << random.below(40)));
    } else if (old.type(0) == 2) {
        const auto bits =
            std::bit_cast<std::uint64_t>(old.real(0)) ^ (std::uint64_t{1} << random.below(64));
        change.bind(1, std::bit_cast<double>(bits));
    } else if (old.type(0) == 3) {
        std::string text = old.text(0);
        const auto words = words_of(database, table, column);
        if (words.empty()) {
            const bool number = text.find_first_not_of("0123456789") == std::string::npos;
            text += text.empty() ? "a" : "";
            auto& letter = text.at(random.index(text.size()));
            letter = number ? (letter == '7' ? '8' : '7') : (letter == 'e' ? 'a' : 'e');
        } else {
            text = words[random.index(words.size())];
        }
        change.bind(1, text);
    } else {
        const auto blob = old.blob(0);
        std::vector<std::byte> bytes(blob.begin(), blob.end());
        bytes[random.index(bytes.size())] ^= std::byte{1} << random.below(8);
        change.bind(1, std::span<const std::byte>(bytes));
    }
    change.run();
}

inline std::int64_t a_row(data::Database& database, const std::string& table, Random& random) {
    std::vector<std::int64_t> ids =
        integers(database.prepare(fmt::format("SELECT rowid FROM {} ORDER BY rowid", table)));
    REQUIRE_FALSE(ids.empty());
    return ids[random.index(ids.size())];
}

inline std::string value_of(data::Database& database,
                            const std::string& table,
                            const std::string& column,
                            std::int64_t row) {
    auto now = database.prepare(
        fmt::format("SELECT quote({0}) FROM {1} WHERE rowid = ?1", column, table), row);
    return now.step() ? now.text(0) : "another row";
}

/// One bit of one tick of a chunk changed, and all of it packed again in full, with the right
/// checksum and the right hash: nothing of the chunk itself gives the change away.
inline void repack(data::Database& database,
                   std::int64_t row,
                   const std::set<std::string>& columns,
                   Random& random) {
    auto old = database.prepare(
        "SELECT trial_id, first_tick, ticks, period_ns FROM trace_chunk WHERE rowid = ?1", row);
    REQUIRE(old.step());
    const auto all = data::TraceReader(database).stored(old.integer(0));
    const auto begin = all.begin() + old.integer(1);
    std::vector<engine::TickRecord> ticks(begin, begin + old.integer(2));
    std::vector<data::TraceColumn> some;
    for (const data::TraceColumn& column : data::trace_columns()) {
        if (columns.contains(std::string(column.name))) {
            some.push_back(column);
        }
    }
    const data::TraceColumn& column = some[random.index(some.size())];
    engine::TickRecord& tick = ticks[random.index(ticks.size())];
    auto* bytes = reinterpret_cast<std::byte*>(&tick) + column.offset;
    bytes[random.below(static_cast<int>(column.size))] ^=
        std::byte{1} << random.below(column.name == "mode" ? 2 : 8);
    const data::EncodedChunk chunk =
        data::encode_chunk(ticks, old.integer(1), old.integer(3), data::kAllParts);
    database.run(
        "UPDATE trace_chunk SET data = ?1, crc32 = ?2, derived = ?3, holds = ?4 WHERE rowid = ?5",
        std::span<const std::byte>(chunk.data), chunk.crc32,
        std::bit_cast<std::int64_t>(data::derived_hash(ticks)), data::parts_text(data::kAllParts),
        row);
}

/// One seeded edit of a value of `row`, undone at the end: it must be reported.
/// @param by_itself  becomes true if something else than a seal reports it
/// @return whether SQLite let it through and the value is another one
inline bool check_edit(data::Database& database,
                       const std::string& table,
                       const std::string& column,
                       std::int64_t row,
                       Random& random,
                       bool* by_itself = nullptr) {
    const Undone undone(database);
    const std::string before = value_of(database, table, column, row);
    try {
        edit(database, table, column, row, random);
    } catch (const data::StoreError&) {
        return false;  // a constraint refuses it
    }
    const std::string after = value_of(database, table, column, row);
    if (after == before) {
        return false;  // the sign of zero
    }
    const data::Verification found = data::verify(database);
    CAPTURE(table, column, row, before.substr(0, 60), after.substr(0, 60), text_of(found));
    const bool decay = column.ends_with("_decay");  // exp() of other machines is forgiven, and said
    CHECK(found.count(data::FindingKind::differs) +
              (decay ? found.count(data::FindingKind::missing) : 0) >
          0);
    if (by_itself != nullptr) {
        const auto other = [](const data::Finding& one) {
            return one.what.find("seal") == std::string::npos;
        };
        *by_itself = *by_itself || std::ranges::any_of(found.file, other);
        for (const auto& session : found.sessions) {
            *by_itself = *by_itself || std::ranges::any_of(session.findings, other);
        }
    }
    return true;
}

/// Makes `count` seeded edits one by one. @return how many SQLite let through
inline int check_edits(data::Database& database,
                       const Words& columns,
                       int count,
                       std::uint64_t seed) {
    database.execute("PRAGMA foreign_keys = OFF");
    int made = 0;
    for (int i = 0; i < count; ++i) {
        Random random(seed * 1000 + static_cast<std::uint64_t>(i));
        const std::string& name = columns[random.index(columns.size())];
        const std::string table = name.substr(0, name.find('.'));
        const std::string column = name.substr(name.find('.') + 1);
        const std::int64_t row = a_row(database, table, random);
        CAPTURE(i);
        made += check_edit(database, table, column, row, random) ? 1 : 0;
    }
    return made;
}

}  // namespace palpate::tests
