#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/sync/layout.hpp"

namespace palpate::data {

/// One attempt as a file has it.
struct TrialVersion {
    std::int64_t id = 0;  ///< in its file
    std::string key;      ///< hash of what was there when it began
    std::string content;  ///< hash of all but `invalid`, with the rows that belong to it
    std::string outcome;
    std::string invalid;     ///< why it does not count; empty: it does
    std::int64_t ticks = 0;  ///< stored
};

/// One session as a file has it. Two files can hold the same session (the same uuid) at two
/// moments.
struct SessionVersion {
    std::string file;  ///< as the user named it
    Database* database = nullptr;
    std::int64_t id = 0;  ///< in its file
    std::string uuid;
    std::string study;  ///< SHA-256 of the protocol
    std::string study_name;
    std::string participant;  ///< code: whose it is, by that number
    std::int64_t number = 0;
    std::string run_code;  ///< as it was run
    std::int64_t run_number = 0;
    bool destroyed = false;  ///< on request: all that is left is that it was
    std::string head;        ///< hash of all that is set before the first trial
    bool finished = false;
    std::string end;                   ///< hash of what was set when it finished
    std::vector<TrialVersion> trials;  ///< in the order in which they were run
    std::vector<std::string> events;   ///< hashes, in their order
};

/// All sessions of a file. @param file  how to call it
/// @param hashed  to be compared with others: without it no hash is made, of no trace either
[[nodiscard]] std::vector<SessionVersion> session_versions(Database& database,
                                                           const Layout& layout,
                                                           const std::string& file,
                                                           bool hashed = true);

/// Whether `later` is what `earlier` was or has become: the same beginning, the same trials and
/// events as far as `earlier` has them. Of those a running trial may have gone on, an answer may
/// have been marked not to count, the session may have become another's or been withdrawn, and it
/// may have finished; nothing else changes in a session that goes on. Any version may have been
/// destroyed. A partial order: two files can hold two sessions of one uuid of which neither became
/// the other.
[[nodiscard]] bool became(const SessionVersion& earlier, const SessionVersion& later);

}  // namespace palpate::data
