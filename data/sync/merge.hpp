#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "data/sync/people_merge.hpp"

namespace palpate::data {

/// What a merge did.
struct MergeReport {
    std::size_t added = 0;     ///< sessions that the file did not have
    std::size_t extended = 0;  ///< sessions that went on since
    std::size_t replaced = 0;  ///< sessions that it had otherwise than the preferred file
    std::size_t same = 0;      ///< sessions that the file had as they are
    std::vector<MergeConflict> conflicts;
    std::vector<std::string> notices;  ///< what was settled: of two notes the newest is kept
};

/// Brings the sessions of `inputs` into `file` (made if it is not there), in one transaction.
///
/// A session is known by its uuid, a participant by the code, a study by the hash of its protocol.
/// Merging the same files again changes nothing, and the order of the files does not matter but for
/// row ids: of a session that several files hold, the one that the others became is kept (see
/// became()). Nothing is merged, and a conflict is listed, of
/// - a session of one uuid that two files tell differently, unless only one of them is what the
///   session of `prefer` is or became, of which a notice says what is left out;
/// - a session that was destroyed as one person's in one file, and is another's in a second, unless
///   `prefer` names one of them;
/// - a session whose chain of hashes does not hold (data/store/chain.hpp), or whose study is not
///   what its text says: damaged, or edited by hand;
/// - two sessions that are the same study, participant and number under two uuids;
/// - a session of `file` that a program runs, and another file has gone on with;
/// - all of a participant of palpate simulate of two secrets, who are two people;
/// - all that `inputs` have of a participant of whom two files tell differently what was noted at
///   one time, unless one is `prefer`; of notes of several times the newest is kept, of consent the
///   refusal (see PeopleMerge), and a notice says so.
/// What a participant had destroyed in one file is destroyed in `file` too; their sessions of a
/// file that does not know of it are a conflict until it is done there, unless it is `prefer`.
/// Sessions keep the secrets with which they were drawn; of a person with two numbers for exports
/// the lesser is kept, and two people with one number are a conflict. What `file` itself holds
/// stays, but for a session that `prefer` tells differently. The inputs are only read, also while a
/// rig writes them.
/// @throws StoreError if a file cannot be read or written, or says otherwise how ticks are written:
/// nothing was merged
[[nodiscard]] MergeReport merge_files(const std::string& file,
                                      const std::vector<std::string>& inputs,
                                      const std::string& prefer = {});

}  // namespace palpate::data
