#include "data/extension/sample_module.hpp"

#include <memory>
#include <string>
#include <variant>

#include <sqlite3ext.h>

#include "data/extension/functions.hpp"
#include "data/extension/part_chunks.hpp"
#include "data/extension/query.hpp"
#include "data/extension/sample_scan.hpp"
#include "data/trace/columns.hpp"

SQLITE_EXTENSION_INIT3

namespace palpate::data {
namespace {

constexpr auto kKeys =
    static_cast<std::size_t>(SampleColumn::tick);  // columns before those of a tick

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

void give(sqlite3_context* context, const TickValue& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        sqlite3_result_int64(context, *whole);
    } else if (const auto* number = std::get_if<double>(&value)) {
        sqlite3_result_double(context, *number);  // NaN is NULL
    } else {
        const auto text = std::get<std::string_view>(value);  // of a name that stays
        sqlite3_result_text(context, text.data(), static_cast<int>(text.size()), SQLITE_STATIC);
    }
}

TickValue value_of(const SampleCursor& at, SampleColumn column) {
    switch (column) {
        case SampleColumn::trial_id:
            return at.part().trial;
        case SampleColumn::interval:
            return at.part().interval;
        case SampleColumn::hip_vx_m_per_s:
            return at.velocity().x;
        case SampleColumn::hip_vy_m_per_s:
            return at.velocity().y;
        case SampleColumn::hip_vz_m_per_s:
            return at.velocity().z;
        case SampleColumn::commanded_x_n:
            return in_whole_steps(at.tick().command.x);
        case SampleColumn::commanded_y_n:
            return in_whole_steps(at.tick().command.y);
        case SampleColumn::commanded_z_n:
            return in_whole_steps(at.tick().command_z);
        default:
            return trace_columns()[static_cast<std::size_t>(column) - kKeys].value(at.tick());
    }
}

int column(sqlite3_vtab_cursor* cursor, sqlite3_context* context, int number) {
    const SampleCursor& at = static_cast<Cursor*>(cursor)->cursor;
    give(context, value_of(at, static_cast<SampleColumn>(number)));
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

bool sample_is_hidden(sqlite3* db) {
    try {
        StatementCache database(db);
        return Query(database,
                     "SELECT 1 FROM main.sqlite_schema WHERE name = 'sample' COLLATE NOCASE"
                     " AND type IN ('table', 'view')")
            .step();
    } catch (const SampleError&) {
        return false;  // whoever asks for ticks hears why the file cannot be read
    }
}

}  // namespace palpate::data
