#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "data/store/database.hpp"
#include "data/sync/postgres.hpp"
#include "data/sync/session_version.hpp"

namespace palpate::data {

/// Who does not consent by a server's notes, and which sessions are theirs: an older copy of a file
/// can have one as another's. Of whom something was destroyed, too.
class Refusals {
public:
    /// @throws PostgresError
    void read(Postgres& server);
    /// Somebody of this code refused.
    [[nodiscard]] bool hold(const std::string& code) const { return codes_.contains(code); }
    /// The session is of who refused, and no note in its file since then says that it is another's.
    [[nodiscard]] bool hold(const SessionVersion& session) const;
    /// When something of theirs was last destroyed in a file that was pushed; "": never.
    [[nodiscard]] std::string destroyed(const std::string& code) const {
        const auto there = destroyed_.find(code);
        return there == destroyed_.end() ? "" : there->second;
    }
    /// A row of participant_note: the session is theirs, who do not consent.
    [[nodiscard]] static PostgresRow note(const SessionVersion& session);

private:
    std::set<std::string> codes_;
    std::map<std::string, std::string> destroyed_;  ///< by code
    std::map<std::string, std::int64_t> moves_;     ///< by uuid: how often it had become another's
};

}  // namespace palpate::data
