#include <sqlite3ext.h>

#include "data/extension/sample_module.hpp"

SQLITE_EXTENSION_INIT1

/// What SQLite calls after it has loaded palpate_sample.so. The module is compiled on its own, so
/// that every call goes through the function table of whoever loads it: R's SQLite is not the
/// system's.
extern "C" __attribute__((visibility("default"))) int sqlite3_palpatesample_init(
    sqlite3* db, char** error, const sqlite3_api_routines* api) {
    SQLITE_EXTENSION_INIT2(api);
    constexpr int kOldest = 3038000;  // 2022
    if (sqlite3_libversion_number() < kOldest) {
        *error = sqlite3_mprintf("palpate_sample needs SQLite 3.38 or newer, this is %s",
                                 sqlite3_libversion());
        return SQLITE_ERROR;
    }
    return palpate::data::add_extension(db);
}
