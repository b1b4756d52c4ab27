#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "data/store/database.hpp"

/// A study as one page of HTML that stands alone: no script, no file beside it, nothing asked of a
/// network.
namespace palpate::data {

struct PageOptions {
    std::string kind = "real";           ///< real, pilot or simulated: never two of them
    std::string study{};                 ///< needed where the file has several of that kind
    bool codes = false;                  ///< people by the lab's codes, not by numbers of this page
    std::vector<std::string> signals{};  ///< of yes/no: the shapes for which yes is right
    std::size_t simulations =
        199;  ///< of the mixed model without an effect: StatsOptions::simulations
    std::size_t bootstrap = 500;  ///< of psychometric functions: FitOptions::bootstrap
    std::string version{};        ///< of the program that makes the page
};

/// Flow and exclusions, confusions, the effect of friction within person, ratings, psychometric
/// functions and their tracks, times, confidence, learning, exploration, the audit, health of the
/// rig, seals, methods; beside every figure its table, CSV and SQL. Numbers are those of
/// stats_of(), audit_of() and fit_all(). People are numbered from 1 in the order of their numbers
/// in exports, which follows from the file's secret. No day is named. The same file gives the same
/// bytes.
/// @throws std::invalid_argument if there is no such session, or several studies: which there are
[[nodiscard]] std::string study_page(Database& database, const PageOptions& options);

}  // namespace palpate::data
