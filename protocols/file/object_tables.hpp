#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocols/file/reader.hpp"
#include "protocols/protocol/protocol.hpp"

/// Private to protocols/format: [[object]] tables, which say more than one key after the other can: free
/// forms by [[object.segment]] tables, and named sets that stand for several objects.
namespace palpate::protocols {

inline constexpr std::size_t kMaxSegments = 64;  ///< of one object

/// Reads one [[object]]: appends one object, or those of a set. Each is noted in `places` as object.N with
/// N its number among all objects.
void read_object(const Table& table,
                 const Position& at,
                 Problems& problems,
                 Places& places,
                 std::vector<ObjectSpec>& objects);

/// The [[object.segment]] tables of a free form as they are read; empty for two curves.
[[nodiscard]] std::string segments_toml(const ObjectSpec& object);

/// What people can say about free forms and sets: part of key_reference().
[[nodiscard]] std::string object_reference();

}  // namespace palpate::protocols
