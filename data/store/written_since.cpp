#include "data/store/written_since.hpp"

#include <sqlite3.h>
#include <sys/stat.h>

namespace palpate::data {

std::int64_t written_ns(const std::string& name) {
    struct stat status {};
    return stat(name.c_str(), &status) != 0
             ? 0
             : std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
}

bool written_since(sqlite3* handle) {
    const char* name = sqlite3_db_filename(handle, "main");
    const std::int64_t then = name == nullptr ? 0 : sqlite3_uri_int64(name, "written", 0);
    return then != 0 && written_ns(name) != then;
}

}  // namespace palpate::data
