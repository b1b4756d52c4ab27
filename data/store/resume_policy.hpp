#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "protocols/session/pending_trials.hpp"
#include "data/store/database.hpp"

/// What happens to the answers of a part of a session that is begun again.
namespace palpate::data {

/// How a session that was broken off goes on.
enum class Resume : std::uint8_t {
    go_on,       ///< with the next trial
    redo_block,  ///< with the first trial of the part of the next one: its practice, or its block
    redo_practice,  ///< with the first practice trial; then with the next of the others
};
inline constexpr std::array<std::string_view, 3> kResumeWords{"continue", "redo-block",
                                                              "redo-practice"};

/// An event "redo" of the session.
struct Redo {
    std::int64_t after = 0;  ///< the last trial that the session had then
    std::size_t part = 0;    ///< as PendingTrials counts
};

[[nodiscard]] std::vector<Redo> redos_of(Database& database, std::int64_t session);

/// Begins a part again: every answer in it that counts is marked with the reason, and stays; an event says
/// so. Nothing happens where nothing was answered.
/// @param pending  what is left; follows
/// @return whether anything was marked
bool begin_again(Database& database,
                 std::int64_t session,
                 Resume how,
                 protocols::PendingTrials& pending);

/// What is left of a session, by what became of every attempt so far. An answer is a row of its own: it
/// decides. @param pending  of the whole plan
[[nodiscard]] protocols::PendingTrials what_is_left(Database& database,
                                                    std::int64_t session,
                                                    protocols::PendingTrials pending);

}  // namespace palpate::data
