#pragma once

#include "protocols/file/reader.hpp"
#include "protocols/protocol/protocol.hpp"

/// Private to protocols/format.
namespace palpate::protocols {

/// What [response] needs of itself: which keys its kind has, and when an answer can be right.
void check_response(const Protocol& protocol, const Places& places, Problems& problems);

}  // namespace palpate::protocols
