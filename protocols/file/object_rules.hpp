#pragma once

#include "protocols/file/reader.hpp"
#include "protocols/protocol/protocol.hpp"

/// Private to protocols/format.
namespace palpate::protocols {

/// What must hold of the objects: pictures differ; two curves fit their chords and leave room for the
/// object; a free form is closed, runs clockwise and does not meet itself; each is of a size to feel,
/// within 1 m of the origin, and leaves the start of a trial outside.
void check_objects(const Protocol& protocol, const Places& places, Problems& problems);

}  // namespace palpate::protocols
