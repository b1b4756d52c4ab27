#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate::data {

/// How much a finding weighs.
enum class FindingKind : std::uint8_t {
    differs,  ///< the file says something else than what follows from the rest of it
    /// Nothing to compare: an older program did not store it, or this machine cannot know it.
    missing,
};

/// One thing that a verification found.
struct Finding {
    FindingKind kind = FindingKind::differs;
    std::optional<std::int64_t> trial;  ///< its id
    std::optional<std::int64_t> tick;   ///< the first one, where ticks differ
    std::string what;                   ///< table.column, or a check of SQLite's
    std::string stored;                 ///< in the file
    std::string recomputed;             ///< what it should be, or why it is not known
    std::int64_t count = 1;             ///< ticks of the trial in which this column differs
};

/// What was looked at in a session, and what was found.
struct SessionReport {
    std::int64_t id = 0;
    std::string study;
    std::string participant;
    std::int64_t number = 0;
    std::string kind;
    bool finished = false;
    std::size_t trials = 0;     ///< attempts
    std::int64_t replayed = 0;  ///< ticks computed again
    std::string head{};         ///< last of its chain of hashes; empty: it has none
    std::vector<Finding> findings{};
};

/// What a verification says about a file.
struct Verification {
    std::vector<Finding> file;  ///< of no session: SQLite's own checks, studies
    std::vector<SessionReport> sessions;

    /// Findings of one kind, in all.
    [[nodiscard]] std::size_t count(FindingKind kind) const noexcept;
};

}  // namespace palpate::data
