#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "data/store/statement.hpp"

namespace palpate::data {

/// What brings the tables of a released schema to the next one. Views need no step: they are made
/// anew from the catalogue.
struct MigrationStep {
    std::int64_t to;  ///< PRAGMA user_version after it: one more than before
    std::string_view sql;
};

/// The steps of all released schemas, in their order. Empty: nothing was released yet.
[[nodiscard]] std::span<const MigrationStep> migration_steps() noexcept;

/// Brings an older file to the last step: first a copy beside it, FILE.schema-N.sqlite with N its
/// version, then all steps in one transaction, all or nothing. A file that is not older stays as it
/// is.
/// @return the name of the copy; "" if nothing was to be done
/// @throws StoreError if a step is missing or fails, or the copy cannot be made; the file is as
/// before
std::string migrate(const Connection& file, std::span<const MigrationStep> steps);

}  // namespace palpate::data
