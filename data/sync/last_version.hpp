#pragma once

#include <string>
#include <vector>

#include "data/sync/people_merge.hpp"
#include "data/sync/session_version.hpp"

namespace palpate::data {

/// Of one session, as the files have it.
using Versions = std::vector<SessionVersion>;

/// "shapes, participant P01, session 1 (its uuid)"
[[nodiscard]] std::string called(const SessionVersion& session);

/// Those that no other version went on from; of equal ones the first.
[[nodiscard]] std::vector<const SessionVersion*> latest_of(const Versions& versions);

/// The version that all others became. Where several went on by themselves, that is a conflict,
/// but for the only one that the preferred version became or is. What was destroyed no preference
/// brings back.
/// @return null: a conflict, which is reported
[[nodiscard]] const SessionVersion* last_of(const Versions& versions,
                                            const std::string& prefer,
                                            PeopleMerge& people,
                                            std::vector<MergeConflict>& conflicts);

}  // namespace palpate::data
