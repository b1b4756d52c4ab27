#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data/store/statement.hpp"

/// The whole schema of a file against the catalogue. A file can come from anywhere, and its schema
/// is a program: triggers that change what is written, views that say something else, a table that
/// is a view without an end.
namespace palpate::data {

/// One table, view, index or trigger that is not the catalogue's.
struct SchemaDifference {
    enum class Of : std::uint8_t {
        table,  ///< ours is gone or another: nothing that is read from it can be trusted
        view,   ///< ours is gone or another
        index,  ///< ours is gone; or one on our table, or a reference to it, decides what it takes
        trigger,  ///< on a table or view of ours
    };
    Of of{};
    std::string name;    ///< "view analysis_trial", "trigger t"
    std::string stored;  ///< its SQL, or that it is not there
    std::string wanted;
};

/// Every difference, tables first. What somebody added of their own is theirs and none: tables,
/// views, triggers on these, plain indices on ours.
[[nodiscard]] std::vector<SchemaDifference> schema_differences(const Connection& file);

/// "table mine, index theirs": what is ordered by a rule of another program (COLLATE), without
/// which SQLite neither checks it nor writes the file anew.
[[nodiscard]] std::string ordered_elsewhere(const Connection& file);
/// "mine, theirs": tables that somebody added and that refer to others.
[[nodiscard]] std::string referring_tables(const Connection& file);

/// @throws WrongFile that names every difference
[[noreturn]] void refuse_schema(const Connection& file,
                                const std::vector<SchemaDifference>& differences,
                                std::string_view so);
/// Names every difference on one line, and says whose views are used.
void remark_schema(const Connection& file, const std::vector<SchemaDifference>& differences);

/// The views of the catalogue as this connection's own, before those of its file. Nothing in the
/// file changes.
void make_own_views(const Connection& file);

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
