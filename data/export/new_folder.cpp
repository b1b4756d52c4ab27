#include "data/export/new_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "engine/base/files.hpp"

namespace palpate::data {
namespace {

void require_synced(const std::filesystem::path& what) {
    if (!sync_to_disk(what)) {
        throw std::runtime_error(fmt::format("{} could not be written to the disk: {}; is it full?",
                                             what.string(), std::strerror(errno)));
    }
}

}  // namespace

NewFolder::NewFolder(std::filesystem::path place) : place_(std::move(place)) {
    if (!place_.has_filename()) {  // "here/"
        place_ = place_.parent_path();
    }
    std::error_code unknown;
    if (place_.empty() ||
        (std::filesystem::exists(std::filesystem::symlink_status(place_, unknown)) &&
         !(std::filesystem::is_directory(place_, unknown) &&
           std::filesystem::is_empty(place_, unknown)))) {
        throw std::invalid_argument(fmt::format(
            "\"{}\" is there already: give -o the name of a new folder", place_.string()));
    }
    remove_leftovers(folder_of(place_));
    std::string name = place_.string() + std::string(kPartName) + "XXXXXX";
    if (mkdtemp(name.data()) == nullptr) {
        throw std::runtime_error(fmt::format(
            "cannot make a folder beside {}: is its parent there and writable?", place_.string()));
    }
    building_ = name;
    held_.emplace(building_);
}

NewFolder::~NewFolder() {
    if (!building_.empty()) {
        std::error_code gone;
        std::filesystem::remove_all(building_, gone);
    }
}

void NewFolder::keep(bool own) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(building_)) {
        if (own) {  // also where it is copied to
            chmod(entry.path().c_str(), S_IRUSR | S_IWUSR | (entry.is_directory() ? S_IXUSR : 0U));
        }
        require_synced(entry.path());
    }
    require_synced(building_);
    if (!own) {
        chmod(building_.c_str(), usual_rights(S_IRWXU | S_IRWXG | S_IRWXO));
    }
    std::error_code failed;
    std::filesystem::rename(building_, place_, failed);
    if (failed) {
        throw std::runtime_error(fmt::format("cannot rename {} to {}: {}", building_.string(),
                                             place_.string(), failed.message()));
    }
    building_.clear();
    static_cast<void>(sync_to_disk(folder_of(place_)));  // some network disks cannot
}

}  // namespace palpate::data
