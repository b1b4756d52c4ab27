#pragma once

#include "protocols/file/reader.hpp"
#include "protocols/protocol/protocol.hpp"

/// Private to protocols/format.
namespace palpate::protocols {

/// Reads the table [procedure]: the keys of AdaptiveSpec and those of a procedure file. What follows from
/// the rule is filled in, and where every key stands. @param entry  of the table, in the protocol's file
void read_adaptive(
    const Entry& entry, Reader& reader, Problems& problems, Places& places, Protocol& protocol);

/// What [procedure], [[run]], [response], [design], objects and frictions need of each other.
void check_adaptive(const Protocol& protocol, const Places& places, Problems& problems);

/// Of two intervals the greater one is asked for: a rule that takes the comparison for it must not choose the
/// standard, or less.
void check_standards(const Protocol& protocol, const Places& places, Problems& problems);

/// Every object that the rule can make of the procedure's, at the ends of what it may choose: what holds for
/// both ends holds between them. Without curvature to vary: none.
[[nodiscard]] std::vector<ObjectSpec> extreme_objects(const Protocol& protocol);

}  // namespace palpate::protocols
