#include "data/store/current_copy.hpp"

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "data/store/schema.hpp"

namespace palpate::data {
namespace {

std::int64_t schema_of(Database& database) {
    Statement row = database.prepare("SELECT user_version FROM pragma_user_version");
    row.step();
    return row.integer(0);
}

void remove(const std::string& folder) {
    std::error_code gone;
    if (!folder.empty()) {
        std::filesystem::remove_all(folder, gone);
    }
}

}  // namespace

CurrentCopy::CurrentCopy(const std::string& file)
    : database_(std::make_unique<Database>(file, Access::read)) {
    if (schema_of(*database_) < kSchemaVersion) {
        try {
            copy_and_migrate();
        } catch (...) {
            database_.reset();
            remove(folder_);
            throw;
        }
    }
}

CurrentCopy::~CurrentCopy() {
    database_.reset();
    remove(folder_);
}

void CurrentCopy::copy_and_migrate() {
    std::string folder = (std::filesystem::temp_directory_path() / "palpate-XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) {
        throw StoreError("cannot make a temporary folder: is TMPDIR there and writable?");
    }
    folder_ = folder;
    const std::string copy = folder + "/copy.sqlite";
    database_->prepare("VACUUM INTO ?1").bind(1, std::string_view(copy)).run();
    database_.reset();
    database_ = std::make_unique<Database>(copy, Access::write);
}

}  // namespace palpate::data
