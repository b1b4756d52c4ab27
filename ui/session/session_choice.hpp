#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "data/store/session_store.hpp"
#include "ui/session/load_study.hpp"

namespace palpate::ui {

/// @param word  what the id was given as
/// @throws std::invalid_argument unless the id is 1 to 64 letters, digits, - or _
void check_participant(const std::string& id, std::string_view word = "--participant");

/// Of a participant whom the file does not know, beside one whose code could be meant.
/// @param insists  --another was given: it is somebody else
/// @throws std::invalid_argument with both codes, and how to insist
void check_known(data::Database& database, const std::string& id, bool insists);

/// Which session of which seed is meant.
struct SessionChoice {
    protocols::SessionKey key;
    std::uint64_t seed = 0;
    std::size_t last = 0;        ///< the participant's last session; 0: none
    data::SessionState there{};  ///< as the file has it; until it has begun its run_as is `key`
};

/// The session asked for, else the participant's last one, else the first. Its seed is the one
/// asked for, else that with which it was begun, else the protocol's; its secret that with which it
/// was begun, else the file's.
[[nodiscard]] SessionChoice choose_session(data::Database& database,
                                           const Study& study,
                                           const std::string& participant,
                                           std::optional<std::size_t> session,
                                           std::optional<std::uint64_t> seed);

/// Of a session that has begun: as another kind it does not go on.
/// @throws std::invalid_argument with both
void require_kind(const SessionChoice& choice,
                  const Study& study,
                  data::RunKind kind,
                  const std::string& file);

}  // namespace palpate::ui
