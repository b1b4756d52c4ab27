#include "data/verify/library_versions.hpp"

#include <sodium.h>
#include <sqlite3.h>
#include <zlib.h>

namespace palpate::data {

std::vector<std::pair<std::string, std::string>> library_versions() {
    return {{"sqlite", std::string(sqlite3_libversion()) + " " + sqlite3_sourceid()},
            {"zlib", zlibVersion()},
            {"libsodium", sodium_version_string()}};
}

}  // namespace palpate::data
