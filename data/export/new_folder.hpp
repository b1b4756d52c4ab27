#pragma once

#include <filesystem>
#include <optional>

#include "engine/base/files.hpp"

namespace palpate::data {

/// A folder that is there whole or not at all: filled under another name beside its place, and
/// renamed by keep(). Removed with all that is in it if keep() was not reached.
class NewFolder {
public:
    /// @throws std::invalid_argument if something other than an empty folder is there
    /// @throws std::runtime_error if it cannot be made
    explicit NewFolder(std::filesystem::path place);
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;
    ~NewFolder();

    /// Where to write until keep().
    [[nodiscard]] const std::filesystem::path& path() const { return building_; }
    /// @param own  nobody but its owner may look inside, nor into its files where they are copied
    /// to
    void keep(bool own = false);

private:
    std::filesystem::path place_;
    std::filesystem::path building_;
    std::optional<PartLock> held_;
};

}  // namespace palpate::data
