#pragma once

#include "data/trace/ticks.hpp"
#include "data/verify/findings.hpp"

namespace palpate::data {

/// Checks one session and its trials. @param session the row of the session with those of its study
/// and its participant: name, title, code, protocol_sha256, protocol_toml
/// @param rooms  for ticks, of sessions before: for those to come
[[nodiscard]] SessionReport check_session(Database& database,
                                          const StoredRow& session,
                                          TickRooms& rooms);

}  // namespace palpate::data
