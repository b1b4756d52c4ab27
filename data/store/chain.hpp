#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/session/recorder.hpp"
#include "data/store/database.hpp"

/// A chain of SHA-256 hashes through a session: each trial that ended, each event and the session's
/// end carry the head that they made. Who edits, removes or reorders anything before a head has to
/// recompute it and all later ones; a head noted in a lab book shows that too. session.head is the
/// newest: without it, or a later one, the last links could be taken away.
///
/// The first link hashes what a session is before its first trial: its row without `finished` and
/// the like, protocol hash and the pseudonym under which it was run, provenance, plan and pictures.
/// Each next one hashes the head before it and: of a trial its row and its rows in every other
/// table (of a trace chunk's data their SHA-256); of an event its row, with position and attempt of
/// its trial; of the end what was set then. Row numbers are in none of them: files may be merged.
/// NULLs neither: a later schema may have more columns. What is noted later (`mark`, `note`,
/// `participant`) is an event; trial.invalid goes in as it was at the end of the trial, and must be
/// what the mark says. The same holds of whose session it is and of withdrawn_reason.
namespace palpate::data {

/// A value that is not the one that was chained, or not what follows from another.
struct ChainBreak {
    std::int64_t trial = 0;  ///< 0: of the session as a whole
    std::string what;        ///< table.column; of an event which
    std::string stored;
    std::string recomputed;
};

/// Where a study's row does not follow from its text: the SHA-256, by which its sessions know it,
/// the name and the title. No seal of a session is over the text.
[[nodiscard]] std::vector<ChainBreak> study_breaks(Database& database, std::int64_t study);

/// @throws StoreError if a study is not what its text says (study_breaks())
void require_study(Database& database, std::int64_t study);

/// Writes the head of a trial that has just got its outcome. In the caller's transaction, as its
/// last words.
void chain_trial(Database& database, std::int64_t trial);
/// The same for the end of a session.
void chain_session(Database& database, std::int64_t session);

/// Adds an event, now, and its head. In the caller's transaction.
/// @param operator_name  who noted it; empty: nobody is named
/// @param noted_utc      of what had been noted before; empty: it is noted now
/// @return the new head
std::string add_event(Database& database,
                      std::int64_t session,
                      const protocols::Event& event,
                      std::string_view operator_name = {},
                      std::string_view noted_utc = {});

/// Why somebody notes something, and who it is; no name: nobody is named.
struct Reason {
    std::string_view text;
    std::string_view operator_name{};
};

/// The answer of `trial` does not count for this reason: its row and an event say so. In the
/// caller's transaction. @return the new head
/// @param undone  the mark is taken back: the answer counts again
std::string add_mark(Database& database,
                     std::int64_t session,
                     std::int64_t trial,
                     const Reason& why,
                     bool undone = false);

/// The reason that a mark noted of a trial; none: it has no mark, or its last one was taken back.
[[nodiscard]] std::optional<std::string> mark_reason(Database& database, std::int64_t trial);

/// Why a session is left out, as its last mark without a trial says; none: it is not.
[[nodiscard]] std::optional<std::string> withdrawal(Database& database, std::int64_t session);

/// The key of a note of a participant: the session is not of whom it was run as, but of `value`, by
/// the number `count`.
inline constexpr std::string_view kIsReally = "is really";
/// The key of the mark of a session whose data were destroyed on request; its value is the newest
/// seal by then.
inline constexpr std::string_view kDestroyed = "destroyed";

/// Makes all links of a session anew, by what it is now: where it is planned again before its first
/// trial, or something of it was destroyed. In the caller's transaction.
void chain_anew(Database& database, std::int64_t session);

/// The newest head of a session; empty: it has none yet.
[[nodiscard]] std::string chain_head(Database& database, std::int64_t session);

/// chain_head() of a session that ended, once the file was opened anew and had all of the session
/// as it was chained. @param breaks  that it had before, by hand
/// @throws StoreError if it has not: something wrote over it
[[nodiscard]] std::string kept_head(Database& database, std::int64_t session, std::size_t breaks);

/// Every head that is not what its session's rows give, every mark whose answer says otherwise, and
/// what of its study is not what the text says (study_breaks()).
[[nodiscard]] std::vector<ChainBreak> chain_breaks(Database& database, std::int64_t session);

}  // namespace palpate::data
