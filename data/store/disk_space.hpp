#pragma once

#include <cstdint>
#include <string>

#include "protocols/protocol/protocol.hpp"

namespace palpate::data {

/// Bytes that `trials` of a protocol can take at most: every one until its time-out, 40 bytes a
/// tick, and 16 MB for the log and all else. Measured: 5 to 12 bytes a tick where a replay gives
/// the rest; 40 leaves room for a device without encoders, and for the log beside the file, which
/// holds a part of it twice.
[[nodiscard]] std::int64_t bytes_needed(const protocols::Protocol& protocol, std::size_t trials);

/// What the disk of the file, or of its folder while it is not there, can still take, bytes.
/// @throws StoreError if nobody knows it
[[nodiscard]] std::int64_t bytes_free(const std::string& file);

/// @throws StoreError with a sentence if the disk has less room than `trials` need
void require_space(const std::string& file,
                   const protocols::Protocol& protocol,
                   std::size_t trials);

/// The file under a name that SQLite takes for nothing else: "" would be a database that vanishes,
/// ":memory:" one that never was, "file:..." a URI.
[[nodiscard]] std::string plain_name(const std::string& file);
/// The file as a URI of one that cannot change, for SQLite to read it without any file beside it.
[[nodiscard]] std::string immutable_uri(const std::string& file);

/// An empty file of one's own, before SQLite makes one that others can read.
/// @return whether it was made: there was none
[[nodiscard]] bool made_private(const std::string& file);

/// A new file would begin what another one holds already, and to read it finds nothing.
/// @throws WrongFile where a link leads to none, what was rescued waits for the file's name, or a
/// log is beside it that is another's: SQLite would delete it
void require_not_elsewhere(const std::string& file);

/// A database that nobody writes, where SQLite could not lay its log and the index of it beside it,
/// or must not: made by another user than the file's owner they would keep that one from writing.
/// Where nothing is in a log it needs none. A live or a killed rig leaves both, beside the file
/// itself, wherever a link to it is.
/// @throws StoreError where another user's file has a log without an index
[[nodiscard]] bool lies_still(const std::string& name);

/// The name of the log that SQLite keeps beside a file while anybody has it open to write, wherever
/// a link to it is; empty: there is no file.
[[nodiscard]] std::string log_of(const std::string& name);

/// Something waits in the log. Without it nobody writes the file, and on a full disk, where SQLite
/// finds no room for the log's index, nobody can begin to: it can be read as it is.
[[nodiscard]] bool has_log(const std::string& name);

}  // namespace palpate::data
