#pragma once

#include "data/verify/findings.hpp"

namespace palpate::data {

/// Checks one session and its trials. @param session the row of the session with those of its study
/// and its participant: name, title, code, protocol_sha256, protocol_toml
[[nodiscard]] SessionReport check_session(Database& database, const StoredRow& session);

}  // namespace palpate::data
