#pragma once

#include <memory>
#include <string>

#include "data/store/database.hpp"

namespace palpate::data {

/// A database opened to read, in the present schema: the file itself, or, where an older palpate made it, a
/// copy brought up to date in a temporary folder. The file is never changed.
class CurrentCopy {
public:
    /// @throws StoreError as Database does
    explicit CurrentCopy(const std::string& file);
    CurrentCopy(const CurrentCopy&) = delete;
    CurrentCopy& operator=(const CurrentCopy&) = delete;
    ~CurrentCopy();

    [[nodiscard]] Database& database() { return *database_; }

private:
    void copy_and_migrate();

    std::string folder_;  ///< of the copy; empty: there is none
    std::unique_ptr<Database> database_;
};

}  // namespace palpate::data
