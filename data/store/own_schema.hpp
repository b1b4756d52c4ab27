#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "data/sql/statement.hpp"

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

/// Of a damaged page fewer rows may be read, and nothing said: each is looked at, but for those of
/// ticks, which have sums of their own. @throws StoreError by the first one
void require_sound_pages(const Connection& file);

/// @throws WrongFile that names every difference
[[noreturn]] void refuse_schema(const Connection& file,
                                const std::vector<SchemaDifference>& differences,
                                std::string_view so);
/// Names every difference on one line, and says whose views are used.
void remark_schema(const Connection& file, const std::vector<SchemaDifference>& differences);

/// The views of the catalogue as this connection's own, before those of its file. Nothing in the
/// file changes.
void make_own_views(const Connection& file);

}  // namespace palpate::data
