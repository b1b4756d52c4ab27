#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

namespace palpate::data {

/// The tables of export_csv() as Parquet files (zstd), ticks of all trials in one ticks.parquet,
/// through DuckDB (duckdb.hpp). columns.csv and README.txt stay beside them.
/// @throws std::invalid_argument if its library is not there: says where to get it
void export_parquet(Database& database,
                    const Selection& selection,
                    const ExportOptions& options,
                    const std::filesystem::path& folder);

}  // namespace palpate::data
