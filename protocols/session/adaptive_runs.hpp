#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/procedure/procedure.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/presentation.hpp"

/// The rules of a session on their way.
namespace palpate::protocols {

/// One procedure for every [[run]] of a protocol, each with a stream of its own (run_key). A value.
class AdaptiveRuns {
public:
    AdaptiveRuns() = default;  ///< of a protocol without a rule
    /// @param session  the session's key; purpose and block are set here
    AdaptiveRuns(const Protocol& protocol, const StreamKey& session);

    /// What the rule shows next. @throws std::logic_error if the run has ended
    [[nodiscard]] double next(std::size_t run) const;
    /// @throws std::invalid_argument as Procedure::update
    void update(const RuleAnswer& answer);
    /// The run as it was before its first answer.
    void restart(std::size_t run) { procedures_.at(run) = begun_.at(run); }
    /// What the rule says with `answer`, its last one.
    [[nodiscard]] AdaptiveStep step_after(const RuleAnswer& answer) const;
    [[nodiscard]] const Procedure& of(std::size_t run) const { return procedures_.at(run); }
    [[nodiscard]] std::size_t size() const noexcept { return procedures_.size(); }

private:
    std::vector<Procedure> begun_;  ///< before the first answer
    std::vector<Procedure> procedures_;
};

/// The stimulus of a planned trial: the rule's next one, in practice that of the protocol; none
/// without a rule.
[[nodiscard]] std::optional<double> stimulus_for(const Protocol& protocol,
                                                 const PlannedTrial& planned,
                                                 const AdaptiveRuns& runs);

/// An answer as the rule counts: two intervals: 1 if the comparison was named; yes or no: 1 for
/// yes; pictures: the place of the named object among the pictured ones in the protocol; a rating:
/// its level.
[[nodiscard]] std::size_t outcome_of(const Protocol& protocol,
                                     const PlannedTrial& planned,
                                     const Response& response);

/// Whether answer `place` is right, where that can be said. Two intervals: the one with the larger
/// value of what varies; none if both have the same. Pictures without a rule: the felt object's;
/// none if there is no such picture.
[[nodiscard]] std::optional<bool> is_right(const Protocol& protocol,
                                           const Plan& plan,
                                           const PlannedTrial& planned,
                                           std::span<const Presentation> felt,
                                           std::size_t place);

}  // namespace palpate::protocols
