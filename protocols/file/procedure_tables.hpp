#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocols/file/reader.hpp"
#include "protocols/procedure/procedure.hpp"

/// Private to protocols/format: a procedure file's tables, wherever they stand.
namespace palpate::protocols {

/// The rule in the tables of a procedure file; [stream] is not looked at. Nothing if there are problems.
[[nodiscard]] std::optional<ProcedureSpec> read_procedure(const Table& file, Problems& problems);

/// The tables as a procedure file: keys in the order of procedure_keys(), numbers as short as they can be.
/// Read and written again it is the same text. [stream] is left out.
/// @pre read_procedure() finds no problem
[[nodiscard]] std::string procedure_text(const Table& file);

/// The same text as a part of a protocol: the keys of its [procedure] first, without that heading, then
/// its other tables as [procedure.model], [[procedure.staircase]], ...
[[nodiscard]] std::string nested_in_protocol(std::string_view procedure_text);

}  // namespace palpate::protocols
