#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/order/constrained_order.hpp"
#include "protocols/protocol/condition.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

enum class Phase : std::uint8_t { practice, main, catch_trial };

/// "practice", "main" or "catch", as the database has it.
[[nodiscard]] std::string_view to_string(Phase phase) noexcept;

/// What is planned of a trial whose stimulus a rule chooses.
struct AdaptiveTrial {
    std::size_t run = 0;                ///< index into Protocol::runs
    std::size_t comparison = 1;         ///< the interval that holds the rule's stimulus, 1 or 2
    std::size_t standard_friction = 0;  ///< of the other interval, index into Protocol::frictions

    friend bool operator==(const AdaptiveTrial&, const AdaptiveTrial&) = default;
};

/// One trial of a session, as it is planned before the first one.
struct PlannedTrial {
    std::size_t position = 0;  ///< 0, 1, 2, ... through the whole session
    Phase phase = Phase::main;
    Condition condition{};  ///< with `adaptive`: the standard object, and the comparison's friction
    bool break_before = false;
    std::size_t block = 0;                    ///< of the main phase, 0, 1, ...; 0 in practice
    std::optional<AdaptiveTrial> adaptive{};  ///< a rule chooses what is felt

    friend bool operator==(const PlannedTrial&, const PlannedTrial&) = default;
};

/// Who runs what: the key of every random stream and of the session's row.
struct SessionKey {
    std::string participant;
    std::size_t session = 1;  ///< 1, 2, ...
    std::string secret{};     ///< of the file, StreamKey::secret; empty: an example
};

/// The whole session, complete before its first trial.
struct Plan {
    std::vector<PlannedTrial> trials;
    std::vector<std::size_t>
        picture_order;           ///< place on the screen -> index into Protocol::objects
    std::uint64_t attempts = 1;  ///< orders proposed for the main phase until its limits were kept
    OrderWay way = OrderWay::shuffles;  ///< how they were
    /// SHA-256, hex, of the trials and pictures and of what they were drawn from: protocol,
    /// participant, session number, seed, secret, and of an adaptive study the rule and its
    /// streams. How many orders were proposed is not in it.
    std::string hash;

    friend bool operator==(const Plan&, const Plan&) = default;
};

/// Numbers the trials, and puts breaks: before the first one after `practice` of them, if there are
/// any, and before every break_every-th of the main and catch trials, 0: none.
void place(std::vector<PlannedTrial>& trials, std::size_t practice, std::size_t break_every);

// The cells of a design.

/// Indices of the objects that are pictured, or of those that are not (catch objects), in file
/// order.
[[nodiscard]] std::vector<std::size_t> objects_of(const Protocol& protocol, bool pictured);

/// Every pictured object with every friction, `repetitions` times, in file order.
[[nodiscard]] std::vector<Condition> factorial(const Protocol& protocol, std::size_t repetitions);

}  // namespace palpate::protocols
