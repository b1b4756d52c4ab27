#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/store/database.hpp"

/// What belongs to what in a palpate database, read from the catalogue, so that files can be
/// brought together whatever tables a later schema adds. What somebody added to a file is theirs:
/// it goes nowhere.
namespace palpate::data {

/// A table whose rows belong to one session or trial.
struct OwnedTable {
    std::string name;
    std::vector<std::string> columns;  ///< without the owner's

    /// "a, b, c"
    [[nodiscard]] std::string list() const;
    /// SELECT list() of the owner ?1, in an order that depends on the content alone.
    [[nodiscard]] std::string select(std::string_view owner) const;
};

/// What belongs to what, so that it can be copied into another file.
struct Layout {
    std::vector<OwnedTable> of_session;  ///< plan, picture, ...: set before the first trial
    std::vector<OwnedTable> of_trial;    ///< response, trace_chunk, ...
    OwnedTable trace_column;             ///< nobody's, the same in every file
    /// Set before the first trial: without session_id, study_id, participant_id, newest_seal.
    OwnedTable session;
    OwnedTable session_end;      ///< set when it finished
    OwnedTable session_repairs;  ///< set by events later: whose it is, whether it is left out
    OwnedTable trial;            ///< without trial_id, session_id, invalid_reason
    OwnedTable event;            ///< without event_id, session_id, trial_id
};

/// By the catalogue of this program.
[[nodiscard]] Layout catalogue_layout();

/// One attempt as a file has it.
struct TrialVersion {
    std::int64_t id = 0;    ///< in its file
    std::string key{};      ///< hash of what was there when it began
    std::string content{};  ///< hash of all but `invalid`, with the rows that belong to it
    std::string outcome{};
    std::string invalid{};   ///< why it does not count; empty: it does
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
    bool destroyed = false;        ///< on request: all that is left is that it was
    std::size_t destructions = 0;  ///< how often that or a score was, with new seals each time
    std::string head;              ///< hash of all that is set before the first trial
    bool finished = false;
    std::string end;                   ///< hash of what was set when it finished
    std::vector<TrialVersion> trials;  ///< in the order in which they were run
    std::vector<std::string> events;   ///< hashes, in their order
    std::vector<std::string> moments;  ///< of the events
};

/// "shapes, participant P01, session 1 (its uuid)"
[[nodiscard]] std::string called(const SessionVersion& session);

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
/// destroyed, and any score in it, after which no seal is as before. A partial order: two files can
/// hold two sessions of one uuid of which neither became the other.
[[nodiscard]] bool became(const SessionVersion& earlier, const SessionVersion& later);

/// Copies a session that `out` does not have, with its study, into it. Its participant is there.
/// @pre its study is what the text says (study_breaks()): so it becomes in `out`
void add_session(const SessionVersion& from, Database& out, const Layout& layout);

/// Brings `own`, a session of `out`, to what it became in `from`. Its rows keep their ids.
/// @pre became(own, from)
void extend_session(const SessionVersion& from,
                    const SessionVersion& own,
                    Database& out,
                    const Layout& layout);

/// The same where `own` did not become `from`: it goes, and its rows get other ids.
void replace_session(const SessionVersion& from,
                     const SessionVersion& own,
                     Database& out,
                     const Layout& layout);

/// Copies what is nobody's in a file: secrets; how traces are written is the same in all.
/// @param file  how to call `from`
/// @throws StoreError where `from` says that they are written otherwise
void copy_shared(Database& from, Database& out, const std::string& file);

/// Copies the one session of `from`, with its participant, into `out`, which does not have it. In
/// the caller's transaction, with deferred foreign keys.
void append_session(Database& from, Database& out, const Layout& layout);

}  // namespace palpate::data
