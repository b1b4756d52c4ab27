#pragma once

#include <algorithm>
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

}  // namespace palpate::data
