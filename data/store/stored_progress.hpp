#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/session/progress.hpp"
#include "data/store/database.hpp"

/// What a session knew and knows, folded from its rows (protocols::SessionProgress).
namespace palpate::data {

/// How a session that was broken off goes on.
enum class Resume : std::uint8_t {
    go_on,       ///< with the next trial
    redo_block,  ///< with the first trial of the part of the next one: its practice, or its block
    redo_practice,  ///< with the first practice trial; then with the next of the others
};
inline constexpr std::array<std::string_view, 3> kResumeWords{"continue", "redo-block",
                                                              "redo-practice"};

/// An event, and when in the session it came.
struct StoredEvent {
    std::int64_t trials_begun = 0;  ///< of the session by then
    protocols::Event event;
};
/// The events of a session in their order.
[[nodiscard]] std::vector<StoredEvent> stored_events(Database& database, std::int64_t session);

/// An attempt as its rows say.
struct StoredAttempt {
    protocols::Attempt attempt;  ///< `counts` as when it ended: a mark came later
    std::string state_hash;      ///< of the rule that took the answer in
};
/// The attempts of a session in their order. One that runs is given as interrupted.
[[nodiscard]] std::vector<StoredAttempt> stored_attempts(Database& database, std::int64_t session);

/// What the session knows by all of its rows. @param begun  before the first trial
/// @throws StoreError if a stored stimulus or state is not what the rule gives: nothing may run
/// then
[[nodiscard]] protocols::SessionProgress stored_progress(Database& database,
                                                         std::int64_t session,
                                                         protocols::SessionProgress begun);

/// Begins a part again: an event says so, and every answer in it that counts is marked with the
/// reason, and stays. Nothing happens where nothing was answered.
/// @return what the session knows then
[[nodiscard]] protocols::SessionProgress begin_again(Database& database,
                                                     std::int64_t session,
                                                     Resume how,
                                                     protocols::SessionProgress progress);

}  // namespace palpate::data
