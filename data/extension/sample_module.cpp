#include "data/extension/sample_module.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <sqlite3ext.h>

#include "data/extension/functions.hpp"
#include "data/extension/sample_cursor.hpp"

SQLITE_EXTENSION_INIT3

namespace palpate::data {
namespace {

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
    const int code = sqlite3_declare_vtab(db, std::string(sample_declaration()).c_str());
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

/// One letter for each value given to filter(), in order.
char letter(int column, unsigned char op) {
    const bool equal = op == SQLITE_INDEX_CONSTRAINT_EQ;
    const bool above = op == SQLITE_INDEX_CONSTRAINT_GT || op == SQLITE_INDEX_CONSTRAINT_GE;
    const bool below = op == SQLITE_INDEX_CONSTRAINT_LT || op == SQLITE_INDEX_CONSTRAINT_LE;
    switch (static_cast<SampleColumn>(column)) {
        case SampleColumn::trial_id:
            return equal ? 'T' : '\0';
        case SampleColumn::interval:
            return equal ? 'I' : '\0';
        case SampleColumn::tick:
            return equal ? 'k' : above ? 'a' : below ? 'b' : '\0';
        case SampleColumn::t_s:
            return equal ? 's' : above ? 'f' : below ? 't' : '\0';
        default:
            return '\0';
    }
}

/// How the rows come by themselves: trial_id, interval, tick or t_s; or the trial's intervals merged.
/// @return '\0' if they do not, else 'n', or 'm' (by time) or 'M' (by tick) for merged
char order_of(const sqlite3_index_info& info, const std::string& letters) {
    const bool one_trial = letters.find('T') != std::string::npos;
    const bool one_interval = letters.find('I') != std::string::npos;
    int next = one_trial ? 1 : 0;  // how many of trial_id, interval, tick are in order so far
    bool merged = false;
    char by = 'n';
    for (int i = 0; i < info.nOrderBy; ++i) {
        const auto column = static_cast<SampleColumn>(info.aOrderBy[i].iColumn);
        if (info.aOrderBy[i].desc != 0 || next > 2) {
            return '\0';
        }
        if (column == SampleColumn::trial_id && (next == 0 || one_trial)) {
            next = std::max(next, 1);
        } else if (column == SampleColumn::interval && !merged && (next == 1 || one_interval)) {
            next = std::max(next, next == 0 ? 0 : 2);
        } else if ((column == SampleColumn::t_s || column == SampleColumn::tick) && next >= 1) {
            merged = next == 1 && !one_interval;
            by = !merged ? 'n' : column == SampleColumn::t_s ? 'm' : 'M';
            next = 3;
        } else {
            return '\0';
        }
    }
    return by;
}

int best_index(sqlite3_vtab* /*table*/, sqlite3_index_info* info) {
    std::string letters;
    for (int i = 0; i < info->nConstraint; ++i) {
        const auto& constraint = info->aConstraint[i];
        const char one = letter(constraint.iColumn, constraint.op);
        if (constraint.usable == 0 || one == '\0' ||
            (std::isupper(static_cast<unsigned char>(one)) != 0 &&
             letters.find(one) != std::string::npos)) {
            continue;
        }
        letters += one;
        info->aConstraintUsage[i].argvIndex = static_cast<int>(letters.size());
        // filter() compares trial and interval as SQLite does; ranges only leave out chunks.
        info->aConstraintUsage[i].omit = one == 'T' || one == 'I' ? 1 : 0;
    }
    const char order = order_of(*info, letters);
    info->orderByConsumed = info->nOrderBy > 0 && order != '\0' ? 1 : 0;
    const bool one_trial = letters.find('T') != std::string::npos;
    const bool one_tick = letters.find('k') != std::string::npos;
    const bool narrow = letters.find_first_of("abfts") != std::string::npos;
    // 30 s at 1 kHz; a trial by its id is found in an index. All trials: dear enough that a join asks for
    // one trial after the other.
    constexpr double kTrial = 3e4;
    constexpr double kAll = 1e12;
    const double rows = one_tick ? 1.0 : narrow ? 0.25 * kTrial : kTrial;
    info->estimatedRows = static_cast<sqlite3_int64>(one_trial ? rows : 1e4 * rows);
    info->estimatedCost = one_trial ? 100.0 + rows : kAll;
    info->idxStr = sqlite3_mprintf("%llx %c%s", static_cast<unsigned long long>(info->colUsed),
                                   info->orderByConsumed != 0 ? order : 'n', letters.c_str());
    info->needToFreeIdxStr = 1;
    return info->idxStr == nullptr ? SQLITE_NOMEM : SQLITE_OK;
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

/// The whole number that an INTEGER column could equal; none for NULL, text, fractions.
std::optional<std::int64_t> equal_to(sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (type == SQLITE_INTEGER) {
        return sqlite3_value_int64(value);
    }
    const double real = sqlite3_value_double(value);
    constexpr double kWhole = 9e15;
    if (type == SQLITE_FLOAT && std::fabs(real) < kWhole && std::floor(real) == real) {
        return static_cast<std::int64_t>(real);
    }
    return std::nullopt;
}

/// Narrows the scan by one constraint. Bounds are widened to inclusive ones: SQLite looks again.
void narrow(SampleScan& scan, char one, sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (one == 'T' || one == 'I') {
        auto& only = one == 'T' ? scan.trial : scan.interval;
        only = equal_to(value);
        scan.nothing = scan.nothing || !only;
        return;
    }
    if (type == SQLITE_NULL) {
        scan.nothing = true;
        return;
    }
    if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) {
        return;  // texts are above all numbers: SQLite sees to it
    }
    const double bound = sqlite3_value_double(value);
    TickRange& range = scan.range;
    if (one == 's' || one == 'f') {
        range.from_s = std::max(range.from_s, bound);
    }
    if (one == 's' || one == 't') {
        range.to_s = std::min(range.to_s, bound);
    }
    const double inside = std::clamp(bound, -1.0, 9e15);
    if (one == 'k' || one == 'a') {
        range.first = std::max(range.first, static_cast<std::int64_t>(std::floor(inside)));
    }
    if (one == 'k' || one == 'b') {
        range.last = std::min(range.last, static_cast<std::int64_t>(std::ceil(inside)));
    }
}

int filter(sqlite3_vtab_cursor* cursor,
           int /*index*/,
           const char* plan,
           int count,
           sqlite3_value** values) {
    return guarded(cursor->pVtab, [&] {
        SampleScan scan;
        const std::string words(plan);
        std::size_t end = 0;
        scan.columns = std::stoull(words, &end, 16);
        const char order = words.at(end + 1);
        scan.by_time = order == 'm';
        scan.by_tick = order == 'M';
        for (int i = 0; i < count; ++i) {
            narrow(scan, words.at(end + 2 + static_cast<std::size_t>(i)), values[i]);
        }
        static_cast<Cursor*>(cursor)->cursor.start(scan);
    });
}

int next(sqlite3_vtab_cursor* cursor) {
    return guarded(cursor->pVtab, [&] { static_cast<Cursor*>(cursor)->cursor.next(); });
}

int at_end(sqlite3_vtab_cursor* cursor) {
    return static_cast<Cursor*>(cursor)->cursor.at_end() ? 1 : 0;
}

void give_mode(sqlite3_context* context, engine::Mode mode) {
    constexpr std::array<const char*, 4> kNames{"free", "stuck", "slip", "transition"};
    sqlite3_result_text(context, kNames.at(static_cast<std::size_t>(mode)), -1, SQLITE_STATIC);
}

/// Whole numbers and texts. @return false: the column is a REAL
bool give_whole(sqlite3_context* context, const SampleCursor& at, SampleColumn column) {
    const engine::TickRecord& tick = at.tick();
    const auto give = [context](std::int64_t value) {
        sqlite3_result_int64(context, value);
    };
    switch (column) {
        case SampleColumn::trial_id:
            give(at.part().trial);
            return true;
        case SampleColumn::interval:
            give(at.part().interval);
            return true;
        case SampleColumn::tick:
            give(tick.tick);
            return true;
        case SampleColumn::mode:
            give_mode(context, tick.mode);
            return true;
        case SampleColumn::segment:
            give(tick.feature);
            return true;
        case SampleColumn::flags:
            give(tick.flags);
            return true;
        case SampleColumn::count_1:
            give(tick.counts[0]);
            return true;
        case SampleColumn::count_2:
            give(tick.counts[1]);
            return true;
        case SampleColumn::code_1:
            give(tick.codes[0]);
            return true;
        case SampleColumn::code_2:
            give(tick.codes[1]);
            return true;
        default:
            return false;
    }
}

double real(const SampleCursor& at, SampleColumn column) {
    const engine::TickRecord& tick = at.tick();
    switch (column) {
        case SampleColumn::t_s:
            return static_cast<double>(tick.time_ns) * 1e-9;
        case SampleColumn::x_m:
            return tick.hip.x;
        case SampleColumn::y_m:
            return tick.hip.y;
        case SampleColumn::vx_m_per_s:
            return at.velocity().x;
        case SampleColumn::vy_m_per_s:
            return at.velocity().y;
        case SampleColumn::cp_x_m:
            return tick.cp.x;
        case SampleColumn::cp_y_m:
            return tick.cp.y;
        case SampleColumn::go_x_m:
            return tick.go.x;
        case SampleColumn::go_y_m:
            return tick.go.y;
        case SampleColumn::u:
            return tick.parameter;
        case SampleColumn::mu:
            return tick.mu;
        case SampleColumn::fn_n:
            return tick.normal_force;
        case SampleColumn::ft_n:
            return tick.tangential_force;
        case SampleColumn::rendered_x_n:
            return tick.force.x;
        case SampleColumn::rendered_y_n:
            return tick.force.y;
        case SampleColumn::fx_n:
            return tick.command.x;
        case SampleColumn::fy_n:
            return tick.command.y;
        default:
            return static_cast<double>(tick.lateness_us);
    }
}

int column(sqlite3_vtab_cursor* cursor, sqlite3_context* context, int number) {
    const SampleCursor& at = static_cast<Cursor*>(cursor)->cursor;
    const auto column = static_cast<SampleColumn>(number);
    if (!give_whole(context, at, column)) {
        sqlite3_result_double(context, real(at, column));  // NaN is NULL
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
    module.xConnect = connect;  // no xCreate: the table is there by its name
    module.xBestIndex = best_index;
    module.xDisconnect = disconnect;
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

int add_sample_module(sqlite3* db) {
    static const sqlite3_module module = make_module();
    return sqlite3_create_module_v2(db, "sample", &module, nullptr, nullptr);
}

int add_extension(sqlite3* db) {
    const int code = add_sample_module(db);
    const int scalars = code != SQLITE_OK ? code : add_scalar_functions(db);
    return scalars != SQLITE_OK ? scalars : add_aggregate_functions(db);
}

}  // namespace palpate::data
