#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "data/analysis/left_out.hpp"
#include "data/export/selection.hpp"

namespace palpate::data {

/// Whose tables are written.
enum class ExportFormat : std::uint8_t {
    csv,
    bids,
    psych_ds,
    parquet,
    procedure,
    quickpsy,
    psignifit,
    psychopy
};

/// In the order of ExportFormat.
inline constexpr std::array<std::string_view, 8> kExportWords{
    "csv", "bids", "psych-ds", "parquet", "procedure", "quickpsy", "psignifit", "psychopy"};

/// The words of kExportWords. @throws std::invalid_argument for another word
[[nodiscard]] ExportFormat parse_export_format(std::string_view word);

/// What was written, and who was left out.
struct ExportSummary {
    std::size_t sessions = 0;           ///< in the folder
    std::vector<LeftOut> left_out{};    ///< of each study and kind, by subject
    std::vector<NotTaken> not_taken{};  ///< studies of which the format holds nothing
};

/// "Nothing is here of 3 pilot sessions of study x: ..."
[[nodiscard]] std::string not_taken_text(const NotTaken& one);

/// Writes a palpate database in a form that others can read, into a new folder: whole or not at
/// all. The database is only read, and sees one moment of it. De-identified unless the options say
/// otherwise (see Selection for what that means); with details or codes nobody but the owner may
/// look into the folder.
/// @throws std::invalid_argument if the folder is there and not empty, nothing is there to export,
///         or details, traces or codes are asked for of a format from procedure on, which has no
///         place for them
/// @throws TraceError if a trace is damaged: nothing is exported then
///
/// A README of the folder says who and what is left out, as every command does; without details
/// none of the lab's words is there.
ExportSummary export_file(const std::string& file,
                          ExportFormat format,
                          const ExportOptions& options,
                          const std::filesystem::path& folder);

/// Writes analysis.R and analysis.py (pandas) into a folder of `export --format csv`: they load its
/// tables, give text columns of fixed words their levels, frictions and objects theirs in the order
/// of least static friction and of curvature, take the main trials that count of one kind of
/// sessions, and print each person's share correct under each friction. To be read and changed:
/// neither is ever written over.
/// @return what was written
/// @throws std::invalid_argument if the folder is no such export, or one of the two is there
/// @throws CsvError if its trials cannot be read
std::vector<std::filesystem::path> write_starters(const std::filesystem::path& folder);

}  // namespace palpate::data
