#pragma once

#include <cstddef>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/protocol/protocol.hpp"

/// Sessions whose stimuli are chosen by a rule: what is planned is all but the stimuli.
namespace palpate::protocols {

/// How many intervals a trial has.
[[nodiscard]] constexpr std::size_t intervals_of(const Protocol& protocol) noexcept {
    return protocol.response.kind == ResponseKind::two_interval ? 2 : 1;
}

/// How many answers the question has.
[[nodiscard]] std::size_t answers_of(const Protocol& protocol);

/// What is felt when the rule chooses `stimulus`: 1/m, mu_s or mm/N.
[[nodiscard]] double felt_value(const AdaptiveSpec& spec, double stimulus);

/// The least and the largest curvature of the object that the rule can make, as objects: what holds
/// for both ends holds between them. None where it varies no curvature, or names no object.
[[nodiscard]] std::vector<ObjectSpec> extreme_objects(const Protocol& protocol);

/// Plans the trials of such a session, the practice first.
///
/// Every run has as many trials as its rule needs, one half with the comparison in the first
/// interval, one half in the second; of an odd number the stream order.main, block 1, draws which
/// has one more. Their order is uniform over all that keep max_run and max_run_interval
/// (OrderSampler, stream order.main). Practice goes through the runs in turn; in which interval its
/// comparisons come is drawn (stream order.practice), with practice_balanced one half of every
/// run's in each, in any order. Breaks as in other sessions.
///
/// @param key  of the session, purpose and block are set here
/// @throws OrderError if no order keeps the limits
void add_adaptive_trials(const Protocol& protocol, const StreamKey& key, Plan& plan);

/// The stream of a run's rule.
[[nodiscard]] StreamKey run_key(StreamKey key, std::size_t run);

/// What the hash of a plan says of its rule: text and key of every run.
[[nodiscard]] std::string rule_lines(const Protocol& protocol, const StreamKey& key);

}  // namespace palpate::protocols
