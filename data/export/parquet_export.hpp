#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

namespace palpate::data {

/// The tables of export_csv() as Parquet files (zstd), ticks of all trials in one ticks.parquet, through
/// DuckDB's C library, which is looked for when this is called: $PALPATE_DUCKDB, or libduckdb.so where the
/// system keeps libraries. columns.csv and README.txt stay beside them.
/// @throws std::invalid_argument if there is no such library: says where to get it
void export_parquet(Database& database,
                    const Selection& selection,
                    const ExportOptions& options,
                    const std::filesystem::path& folder);

}  // namespace palpate::data
