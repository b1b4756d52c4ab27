#pragma once

#include <string>

#include "data/page/study.hpp"
#include "data/store/database.hpp"

/// A study as one page of HTML that stands alone: no script, no file beside it, nothing asked of a
/// network.
namespace palpate::data {

/// Flow and exclusions, confusions, the effect of friction within person, ratings, psychometric
/// functions and their tracks, times, confidence, learning, exploration, the audit, health of the
/// rig, seals, methods; beside every figure its table, CSV and SQL. Numbers are those of
/// stats_of(), audit_of() and fit_all(). People are numbered from 1 in the order of their numbers
/// in exports, which follows from the file's secret. No day is named. The same file gives the same
/// bytes.
/// @throws std::invalid_argument if there is no such session, or several studies: which there are
[[nodiscard]] std::string study_page(Database& database, const PageOptions& options);

}  // namespace palpate::data
