#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "protocols/design/streams.hpp"
#include "protocols/procedure/procedure.hpp"

/// Procedure files (`palpate procedure`): TOML text -> a procedure at its start. What a file may say, key
/// by key: procedure_key_reference(). Problems are reported like those of a protocol.
namespace palpate::protocols {

struct ProcedureFile {
    /// Purpose "procedure"; empty texts unless a recorded run is replayed.
    ProcedureSpec spec;
    Procedure procedure;  ///< of both
};

/// Reads a procedure file. Past this door the grids fit the model, the tables fit into memory and the
/// procedure is ready for its first trial.
/// @param file_name  for messages only
/// @throws ProtocolError with one line a problem: file:line:column, what, the value, what to do
[[nodiscard]] ProcedureFile parse_procedure(std::string_view text, std::string_view file_name);

/// parse_procedure of a file's text. @throws ProtocolError also if the file cannot be read
[[nodiscard]] ProcedureFile load_procedure(const std::filesystem::path& file);

/// All keys for people: table, key, range, default, meaning; one line a key, tables as headings.
[[nodiscard]] std::string procedure_key_reference();

}  // namespace palpate::protocols
