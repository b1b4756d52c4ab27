#pragma once

#include <map>
#include <set>
#include <string>
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

/// What the files say of participants, by code: of two notes the newest, and nothing from before
/// the time when somebody had all destroyed.
class PeopleMerge {
public:
    /// @param prefer  the file that is right where two notes are of one time; empty: that is a
    /// conflict
    explicit PeopleMerge(std::string prefer) : prefer_(std::move(prefer)) {}
    /// @param file  how to call the database
    void read(Database& database, const std::string& file);
    /// Sees that no two people have the same number in exports, when all is read.
    void number();
    /// Of these codes two files say different things.
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

    void say(const std::string& code, const std::string& key, const NotedDetail& said);
    static void write_details(const std::string& code, const Person& person, Statement& detail);
    static void bind_notes(const Person& person, Statement& note);
    static bool stays(const Person& person, const std::string& key);

    std::map<std::string, Person> people_;
    std::set<std::string> in_conflict_;
    std::vector<MergeConflict> conflicts_;
    std::vector<std::string> notices_;
    std::string prefer_;
};

}  // namespace palpate::data
