#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "data/store/database.hpp"

namespace palpate::data {

/// What two files say differently or one says wrongly, so that nothing of it was merged.
struct MergeConflict {
    std::string what;    ///< the session or participant, and what differs
    std::string first;   ///< a file
    std::string second;  ///< the other one; empty: the first alone is at fault
    std::string remedy;  ///< how to settle it
};

inline constexpr const char* kPreferRemedy = "--prefer FILE takes what that one of them says";

/// What the files say of participants, by code: of two notes the newest. Of consent a no, unless a
/// file that has it says yes since. Of whom something was destroyed what the files say that know of
/// it. A file's own notes are in order whatever its clock said (note_time()).
class PeopleMerge {
public:
    /// @param prefer  the file that is right where two notes are of one time; empty: that is a
    /// conflict
    explicit PeopleMerge(std::string prefer) : prefer_(std::move(prefer)) {}
    /// @param file  how to call the database
    void read(Database& database, const std::string& file);
    /// The file has a session of theirs as it was before something of it was destroyed.
    void is_of_before(const std::string& file, const std::string& code) {
        of_before_.insert({file, code});
    }
    /// When all is read. Sees that no two people have the same number in exports, too.
    void settle();
    /// When something of the person was last destroyed, if this file does not know of it, nor can
    /// be preferred for what was noted since; else "". @param noted  when; "": of a session
    [[nodiscard]] std::string destroyed_unknown_to(const std::string& file,
                                                   const std::string& code,
                                                   const std::string& noted = {}) const;
    /// Something that this file has of somebody was destroyed in another.
    [[nodiscard]] bool forgot(const std::string& file) const {
        return std::ranges::any_of(forgot_, [&](const auto& one) { return one.first == file; });
    }
    /// Nothing of this person is merged: two files say different things.
    void leave_out(const std::string& code) { in_conflict_.insert(code); }
    /// These people.
    [[nodiscard]] const std::set<std::string>& in_conflict() const { return in_conflict_; }
    [[nodiscard]] const std::vector<MergeConflict>& conflicts() const { return conflicts_; }
    /// "participant P01: age is 32 (noted ... in b.sqlite), no longer 31 (...)"
    [[nodiscard]] const std::vector<std::string>& notices() const { return notices_; }
    /// Registers all but those in conflict, and fills in what was not known.
    void write(Database& out) const;

private:
    struct NotedDetail {
        std::string value;
        std::string file;
        std::string utc{};  ///< when it was noted
    };
    using Person =
        std::map<std::string, NotedDetail>;  ///< key, value; "detail KEY" for participant_detail

    struct Word {
        std::string code;
        std::string key;
        NotedDetail said;
    };

    void settle_consent(const std::string& code);
    void number();
    void say(const std::string& code, const std::string& key, const NotedDetail& said);

    std::vector<Word> words_;                                  ///< but for consent
    std::map<std::string, std::vector<NotedDetail>> given_;    ///< consent, by code
    std::map<std::string, std::vector<NotedDetail>> refused_;  ///< the same
    std::map<std::string, std::set<std::string>> refusals_;    ///< code, when in any file
    std::map<std::string, std::string> destroyed_;             ///< code, when
    /// File, code, when: of refusals and destructions.
    std::set<std::tuple<std::string, std::string, std::string>> knows_;
    std::set<std::pair<std::string, std::string>> of_before_;  ///< file, code
    std::set<std::pair<std::string, std::string>> forgot_;     ///< file, code
    std::map<std::string, Person> people_;
    std::set<std::string> in_conflict_;
    std::vector<MergeConflict> conflicts_;
    std::vector<std::string> notices_;
    std::string prefer_;
};

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
