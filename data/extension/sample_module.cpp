#include "data/extension/sample_module.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <sqlite3ext.h>

#include "data/extension/sample_cursor.hpp"
#include "data/trace/columns.hpp"

SQLITE_EXTENSION_INIT3

namespace palpate::data {
namespace {

/// The columns by which a scan is narrowed or ordered, in their places.
enum class Key { trial_id, interval, tick, time_s };
constexpr std::size_t kKeys = 2;  // before those of a tick

/// One letter for each value given to filter(), in order.
char letter(int column, unsigned char op) {
    const bool equal = op == SQLITE_INDEX_CONSTRAINT_EQ || op == SQLITE_INDEX_CONSTRAINT_IS;
    const bool above = op == SQLITE_INDEX_CONSTRAINT_GT || op == SQLITE_INDEX_CONSTRAINT_GE;
    const bool below = op == SQLITE_INDEX_CONSTRAINT_LT || op == SQLITE_INDEX_CONSTRAINT_LE;
    const bool beyond = op == SQLITE_INDEX_CONSTRAINT_GT || op == SQLITE_INDEX_CONSTRAINT_LT;
    switch (static_cast<Key>(column)) {
        case Key::trial_id:
            return equal ? 'T' : above ? (beyond ? 'G' : 'g') : below ? (beyond ? 'L' : 'l') : '\0';
        case Key::interval:
            return equal ? 'I' : '\0';
        case Key::tick:
            return equal ? 'k' : above ? 'a' : below ? 'b' : '\0';
        case Key::time_s:
            return equal ? 's' : above ? 'f' : below ? 't' : '\0';
        default:
            return '\0';
    }
}

/// How the rows come by themselves: trial_id, interval, tick or time_s; or the trial's intervals
/// merged.
/// @return '\0' if they do not, else 'n', or 'm' (by time) or 'M' (by tick) for merged
char order_of(const sqlite3_index_info& info, const std::string& letters) {
    const bool one_trial = letters.find('T') != std::string::npos;
    const bool one_interval = letters.find('I') != std::string::npos;
    int next = one_trial ? 1 : 0;  // how many of trial_id, interval, tick are in order so far
    bool merged = false;
    char by = 'n';
    for (int i = 0; i < info.nOrderBy; ++i) {
        const auto column = static_cast<Key>(info.aOrderBy[i].iColumn);
        if (info.aOrderBy[i].desc != 0 || next > 2) {
            return '\0';
        }
        if (column == Key::trial_id && (next == 0 || one_trial)) {
            next = std::max(next, 1);
        } else if (column == Key::interval && !merged && (next == 1 || one_interval)) {
            next = std::max(next, next == 0 ? 0 : 2);
        } else if ((column == Key::time_s || column == Key::tick) && next >= 1) {
            merged = next == 1 && !one_interval;
            by = !merged ? 'n' : column == Key::time_s ? 'm' : 'M';
            next = 3;
        } else {
            return '\0';
        }
    }
    return by;
}

/// A trial by its id is found in an index. All trials are dear, so that a join asks for one trial
/// after the other: as many trials as SQLite takes a table to have rows of which it knows nothing.
void estimate(sqlite3_index_info& info, const std::string& letters) {
    constexpr double kTicks = 3e4;  // 30 s at 1 kHz
    constexpr double kTrials = 1048576.0;
    const auto has = [&letters](std::string_view any) {
        return letters.find_first_of(any) != std::string::npos;
    };
    const double ticks = has("k") ? 1.0 : has("abfts") ? 0.25 * kTicks : kTicks;
    const double trials = has("T") ? 1.0 : has("gGlL") ? 0.25 * kTrials : kTrials;
    info.estimatedRows = static_cast<sqlite3_int64>(trials * ticks);
    info.estimatedCost = has("T") ? 100.0 + ticks : 1e3 * trials * kTicks;
}

constexpr double kWhole = 9e15;  // below it a double's whole number is exact
/// The whole number that an INTEGER column could equal; none for NULL, text, fractions.
std::optional<std::int64_t> equal_to(sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (type == SQLITE_INTEGER) {
        return sqlite3_value_int64(value);
    }
    const double real = sqlite3_value_double(value);
    if (type == SQLITE_FLOAT && std::fabs(real) < kWhole && std::floor(real) == real) {
        return static_cast<std::int64_t>(real);
    }
    return std::nullopt;
}

/// The lowest whole number >= bound, or > bound.
std::int64_t lowest(double bound, bool beyond) noexcept {
    const double whole = beyond ? std::floor(bound) + 1.0 : std::ceil(bound);
    return whole < -kWhole ? INT64_MIN
         : whole > kWhole  ? INT64_MAX
                           : static_cast<std::int64_t>(whole);
}
std::int64_t highest(double bound, bool beyond) noexcept {
    const std::int64_t low = lowest(-bound, beyond);
    return low == INT64_MIN ? INT64_MAX : -low;
}

void narrow(SampleScan& scan, char one, double bound) {
    TickRange& range = scan.range;
    if (one == 's' || one == 'f') {
        range.from_s = std::max(range.from_s, bound);
    }
    if (one == 's' || one == 't') {
        range.to_s = std::min(range.to_s, bound);
    }
    if (one == 'k' || one == 'a') {
        range.first = std::max(range.first, lowest(bound, false));
    }
    if (one == 'k' || one == 'b') {
        range.last = std::min(range.last, highest(bound, false));
    }
    if (one == 'g' || one == 'G') {
        scan.trials.first = std::max(scan.trials.first, lowest(bound, one == 'G'));
    }
    if (one == 'l' || one == 'L') {
        scan.trials.last = std::min(scan.trials.last, highest(bound, one == 'L'));
    }
}

/// Narrows the scan by one constraint. Bounds of ticks and times are widened to inclusive ones:
/// SQLite looks again. Not those of trials: one that nobody asks for may be damaged.
void narrow(SampleScan& scan, char one, sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (one == 'T' || one == 'I') {
        const auto only = equal_to(value);
        scan.nothing = scan.nothing || !only;
        if (only && one == 'T') {
            scan.trials = {std::max(scan.trials.first, *only), std::min(scan.trials.last, *only)};
        } else if (only) {
            scan.interval = only;
        }
        return;
    }
    if (type == SQLITE_NULL) {
        scan.nothing = true;
        return;
    }
    if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) {
        return;  // texts are above all numbers: SQLite sees to it
    }
    narrow(scan, one, sqlite3_value_double(value));
}

/// Which constraints narrow the scan, in which order its rows come, and what that costs. Used are:
/// trial_id and interval with = or IS, ranges of trial_id, tick and time_s; all else SQLite looks
/// at row by row. The choice is info.idxStr.
void choose_scan(sqlite3_index_info& info) {
    std::string letters;
    for (int i = 0; i < info.nConstraint; ++i) {
        const auto& constraint = info.aConstraint[i];
        const char one = letter(constraint.iColumn, constraint.op);
        const bool exact = one == 'T' || one == 'I';
        if (constraint.usable == 0 || one == '\0' ||
            (exact && letters.find(one) != std::string::npos)) {
            continue;
        }
        letters += one;
        info.aConstraintUsage[i].argvIndex = static_cast<int>(letters.size());
        // filter() compares trial and interval as SQLite does; ranges are looked at again.
        info.aConstraintUsage[i].omit = exact ? 1 : 0;
    }
    const char order = order_of(info, letters);
    info.orderByConsumed = info.nOrderBy > 0 && order != '\0' ? 1 : 0;
    estimate(info, letters);
    info.idxStr = sqlite3_mprintf("%llx %c%s", static_cast<unsigned long long>(info.colUsed),
                                  info.orderByConsumed != 0 ? order : 'n', letters.c_str());
    info.needToFreeIdxStr = 1;
    if (info.idxStr == nullptr) {
        throw std::bad_alloc();
    }
}

SampleScan chosen_scan(std::string_view plan, std::span<sqlite3_value* const> values) {
    SampleScan scan;
    const std::string words(plan);
    std::size_t end = 0;
    scan.columns = std::stoull(words, &end, 16);
    const char order = words.at(end + 1);
    scan.by_time = order == 'm';
    scan.by_tick = order == 'M';
    for (std::size_t i = 0; i < values.size(); ++i) {
        narrow(scan, words.at(end + 2 + i), values[i]);
    }
    return scan;
}

struct Table : sqlite3_vtab {
    explicit Table(sqlite3* db) : sqlite3_vtab{}, store(db) {}
    TickStore store;
};

struct Cursor : sqlite3_vtab_cursor {
    explicit Cursor(TickStore& store) : sqlite3_vtab_cursor{}, cursor(store) {}
    SampleCursor cursor;
};

/// What a sentence may come from; SQLite gives it to whoever runs the statement.
template <class Work>
int guarded(sqlite3_vtab* table, const Work& work) {
    try {
        work();
        return SQLITE_OK;
    } catch (const std::bad_alloc&) {
        return SQLITE_NOMEM;
    } catch (const std::exception& e) {
        sqlite3_free(table->zErrMsg);
        table->zErrMsg = sqlite3_mprintf("%s", e.what());
        return SQLITE_ERROR;
    }
}

int connect(sqlite3* db,
            void* /*data*/,
            int /*count*/,
            const char* const* /*words*/,
            sqlite3_vtab** table,
            char** /*error*/) {
    const int code = sqlite3_declare_vtab(db, sample_declaration().c_str());
    if (code != SQLITE_OK) {
        return code;
    }
    try {
        *table = std::make_unique<Table>(db).release();
    } catch (const std::exception&) {
        return SQLITE_NOMEM;
    }
    // It reads the database that it is asked about, and nothing else: views may use it.
    return sqlite3_vtab_config(db, SQLITE_VTAB_INNOCUOUS);
}

int disconnect(sqlite3_vtab* table) {
    delete static_cast<Table*>(table);
    return SQLITE_OK;
}

int best_index(sqlite3_vtab* table, sqlite3_index_info* info) {
    return guarded(table, [info] { choose_scan(*info); });
}

int open_cursor(sqlite3_vtab* table, sqlite3_vtab_cursor** cursor) {
    return guarded(table, [&] {
        *cursor = std::make_unique<Cursor>(static_cast<Table*>(table)->store).release();
    });
}

int close_cursor(sqlite3_vtab_cursor* cursor) {
    delete static_cast<Cursor*>(cursor);
    return SQLITE_OK;
}

int filter(sqlite3_vtab_cursor* cursor,
           int /*index*/,
           const char* plan,
           int count,
           sqlite3_value** values) {
    return guarded(cursor->pVtab, [&] {
        static_cast<Cursor*>(cursor)->cursor.start(
            chosen_scan(plan, {values, static_cast<std::size_t>(count)}));
    });
}

int next(sqlite3_vtab_cursor* cursor) {
    return guarded(cursor->pVtab, [&] { static_cast<Cursor*>(cursor)->cursor.next(); });
}

int at_end(sqlite3_vtab_cursor* cursor) {
    return static_cast<Cursor*>(cursor)->cursor.at_end() ? 1 : 0;
}

/// The command as chunks hold it, whatever else of the tick is exact: the same number with and
/// without a replay.
double in_whole_steps(double command) noexcept {
    return steps_in_newton(in_steps(command, kCommandSteps));
}

/// Where the reals of a tick lie; 0 for what is none.
const auto kReals = [] {
    std::vector<std::size_t> places(kKeys + trace_columns().size() + 3);
    std::ranges::transform(trace_columns(), &places[kKeys], [](const TraceColumn& column) {
        return column.memory == "f64le" ? column.offset : 0;
    });
    return places;
}();

void give(sqlite3_context* context, std::int64_t whole) {
    sqlite3_result_int64(context, whole);
}
void give(sqlite3_context* context, double number) {
    sqlite3_result_double(context, number);  // NaN is NULL
}
void give(sqlite3_context* context, std::string_view text) {  // of a name that stays
    sqlite3_result_text(context, text.data(), static_cast<int>(text.size()), SQLITE_STATIC);
}

/// Apart from column(), which is asked for every value.
[[gnu::noinline]] void give(sqlite3_context* context, const SampleCursor& at, int number) {
    const auto columns = trace_columns();
    const auto place = static_cast<std::size_t>(number) - kKeys;
    if (number < static_cast<int>(kKeys)) {
        give(context, number == 0 ? at.part().trial : at.part().interval);
    } else if (place < columns.size()) {
        std::visit([context](const auto& value) { give(context, value); },
                   columns[place].value(at.tick()));
    } else {
        give(context, at.velocity()[static_cast<int>(place - columns.size())]);
    }
}

int column(sqlite3_vtab_cursor* cursor, sqlite3_context* context, int number) {
    const SampleCursor& at = static_cast<Cursor*>(cursor)->cursor;
    if (const std::size_t place = kReals[static_cast<std::size_t>(number)]; place != 0) {
        const auto* const bytes = reinterpret_cast<const std::byte*>(&at.tick());
        const double real = *reinterpret_cast<const double*>(bytes + place);
        const bool rounded = (kCommandColumns >> number & 1U) != 0 && at.replayed();
        give(context, rounded ? in_whole_steps(real) : real);
    } else {
        give(context, at, number);
    }
    return SQLITE_OK;
}

int row_id(sqlite3_vtab_cursor* cursor, sqlite3_int64* id) {
    const SampleCursor& at = static_cast<Cursor*>(cursor)->cursor;
    *id = (at.part().trial << 38) + (at.part().interval << 36) + at.tick().tick;
    return SQLITE_OK;
}

sqlite3_module make_module() {
    sqlite3_module module{};
    module.iVersion = 1;
    module.xCreate = connect;  // as xConnect: the table is there by its name, and can be made
    module.xConnect = connect;
    module.xBestIndex = best_index;
    module.xDisconnect = disconnect;
    module.xDestroy = disconnect;
    module.xOpen = open_cursor;
    module.xClose = close_cursor;
    module.xFilter = filter;
    module.xNext = next;
    module.xEof = at_end;
    module.xColumn = column;
    module.xRowid = row_id;
    return module;
}

}  // namespace

bool has_own_sample(sqlite3* db) {
    try {
        const LentConnection database(db);
        return Statement(database,
                         "SELECT 1 FROM main.sqlite_schema WHERE name = 'sample' COLLATE NOCASE"
                         " AND type IN ('table', 'view')")
            .step();
    } catch (const SampleError&) {
        return false;  // whoever asks for ticks hears why the file cannot be read
    }
}

int add_sample_module(sqlite3* db) {
    static const sqlite3_module module = make_module();
    const int code = sqlite3_create_module_v2(db, "sample", &module, nullptr, nullptr);
    return code != SQLITE_OK || !has_own_sample(db)
             ? code
             : sqlite3_exec(db, "CREATE VIRTUAL TABLE IF NOT EXISTS temp.sample USING sample",
                            nullptr, nullptr, nullptr);
}

int add_extension(sqlite3* db) {
    const int code = add_sample_module(db);
    const int scalars = code != SQLITE_OK ? code : add_scalar_functions(db);
    return scalars != SQLITE_OK ? scalars : add_aggregate_functions(db);
}

}  // namespace palpate::data
