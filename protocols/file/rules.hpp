#pragma once

#include "protocols/file/reader.hpp"
#include "protocols/protocol/protocol.hpp"

/// Private to protocols/format.
namespace palpate::protocols {

/// What must hold across keys, once every value by itself is right: names are unique, pictures differ,
/// curves fit their chords and leave room for the object, the start is outside, the times are in order,
/// the run limits are feasible.
void check_rules(const Protocol& protocol, const Places& places, Problems& problems);

}  // namespace palpate::protocols
