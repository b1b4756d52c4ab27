#pragma once

#include <string>
#include <utility>
#include <vector>

#include "data/sync/postgres.hpp"
#include "data/sync/session_version.hpp"

namespace palpate::data {

/// A table on the server. All rows but those of studies, people and trace_column begin with their
/// session's uuid, in the primary key too: so they can be partitioned or spread by session, and
/// nothing refers across. Rows are only added, never changed: what changes in a file (a session
/// ends, an answer no longer counts) is a row of its own here.
struct PostgresTable {
    std::string name;
    std::vector<std::pair<std::string, std::string>> columns;  ///< name, PostgreSQL's type
    std::vector<std::string> key;
};

/// catalogue_layout() without the secrets of sessions: who has one can compute whose an order is.
[[nodiscard]] Layout pushed_layout();

/// study, participant_note, session, session_end, trial, trial_invalid, event, and every table of
/// the catalogue that belongs to a session or a trial, with the same columns; trial counts a
/// session's attempts from 1. participant_detail stays in the lab.
/// @param layout  pushed_layout()
[[nodiscard]] std::vector<PostgresTable> postgres_tables(const Layout& layout);

/// SQL that makes the schema `palpate` with these tables where they are not there. Chunks are
/// not compressed again (STORAGE EXTERNAL).
[[nodiscard]] std::string postgres_schema(const std::vector<PostgresTable>& tables);

/// Makes what postgres_schema() makes, if it is not there and the user may.
/// @throws PostgresError where the user may not, or a table is there without one of its columns
void require_schema(Postgres& server, const std::vector<PostgresTable>& tables);

/// SQL for an administrator: roles palpate_writer (adds and reads rows) and palpate_reader (reads),
/// to be granted to people and programs.
[[nodiscard]] std::string postgres_roles();

/// Statements of a row with all columns, parameters $1 and on.
struct PostgresRows {
    std::string insert;  ///< nothing happens if its key is there
    std::string same;    ///< a row if it is there with these values, none of which is NULL
};
[[nodiscard]] PostgresRows postgres_rows(const PostgresTable& table);

}  // namespace palpate::data
