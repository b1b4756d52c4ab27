#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/design/plan.hpp"
#include "protocols/design/protocol.hpp"

namespace palpate::protocols {

/// Indices of the objects that are pictured, or of those that are not (catch objects), in file order.
[[nodiscard]] std::vector<std::size_t> objects_of(const Protocol& protocol, bool pictured);

/// Every pictured object with every friction, `repetitions` times, in file order.
[[nodiscard]] std::vector<Condition> factorial(const Protocol& protocol, std::size_t repetitions);

/// The whole session of one participant. The same arguments give the same plan on every machine.
///
/// 1. Practice: every condition practice_repetitions times, a plain shuffle (stream "order.practice").
/// 2. Main: every condition `repetitions` times, within the run limits (stream "order.main").
/// 3. Catch trials among them, at places drawn uniformly from all but the first (stream "catch"). They
///    cycle over catch objects x frictions, so that each object and each friction comes as equally
///    often as their number allows. They do not count for the run limits: these hold for the main
///    trials as if the catch trials were not there, else the limits would bend where they fall.
/// 4. A break before every break_every-th of the main and catch trials together, and before the first
///    of them if there was practice.
/// 5. Pictures: a row of the Williams design drawn by the stream "pictures", whose key leaves the
///    session out: a participant sees one order in all sessions.
///
/// @param protocol_hash  protocol_hash(protocol)
/// @param seed           the study seed: protocol.seed unless the operator gave another
/// @throws OrderError if no order keeps the run limits
/// @throws std::invalid_argument if there is nothing to run: no pictured object, friction or repetition,
///         or catch trials without a catch object. No protocol read from a file is like that.
[[nodiscard]] Plan make_plan(const Protocol& protocol,
                             std::string_view protocol_hash,
                             const SessionKey& key,
                             std::uint64_t seed);

/// Short code of the plan for the lab book: the first 32 bits of its hash, as in "3f9a-01bc".
[[nodiscard]] std::string session_code(const Plan& plan);

}  // namespace palpate::protocols
