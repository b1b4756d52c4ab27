#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocols/design/plan.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

/// Orders of levels, as names: of the pictures from left to right, or of the first friction blocks.
struct LevelOrders {
    std::vector<std::vector<std::string>> others;  ///< of every other participant who really ran
    std::vector<std::string> own;                  ///< empty: the participant has no session yet
};

/// What is counterbalanced: the row of the pictures; or the frictions of the first main blocks, one
/// round of them, which a session whose blocks mix frictions has not: its entry is empty.
enum class Balanced : std::uint8_t { pictures, frictions };

/// Who already ran the study (by the protocol's id) with which order.
///
/// `others` counts each participant with a real session once, by the first of these; what is
/// simulated, a pilot or withdrawn leaves the balance alone. `own` is the order of the session
/// itself if it is there, so that it goes on as it began, else that of the participant's first
/// session: where a real one asks, of those that `others` would count, else of any. A session
/// counts from its first trial on, and as long as a program runs it: whoever is at the welcome
/// screen has taken the row, whoever left there has not.
/// @param kind  of the session that asks, as to_string(RunKind)
[[nodiscard]] LevelOrders orders_of(Database& database,
                                    Balanced what,
                                    std::string_view study,
                                    const protocols::SessionKey& key,
                                    std::string_view kind = "real");

}  // namespace palpate::data
