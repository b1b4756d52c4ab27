#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocols/design/counterbalance.hpp"
#include "protocols/design/plan.hpp"
#include "protocols/design/streams.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// The key of a session's streams; purpose and block are to be set.
[[nodiscard]] StreamKey session_stream(std::string_view protocol_hash,
                                       const SessionKey& key,
                                       std::uint64_t seed);

/// The whole session of one participant. The same arguments give the same plan on every machine.
///
/// 1. Practice: every condition practice_repetitions times, a plain shuffle (stream
///    practice_order).
/// 2. Main: `blocks` blocks, in each every condition repetitions / blocks times, within the run
///    limits, each order as likely as any other that goes on from the block before within them
///    (OrderSampler; stream main_order, a key for every block). With the rule first_order
///    instead: one block, a sequence in which every condition follows every condition
///    once (eulerian_order; stream main_order). Its first trial has no forerunner: it leads in, as
///    practice. The run limits do not apply. With friction blocks (counterbalance.hpp): `blocks`
///    rounds, in each one block of every friction, with every pictured object repetitions / blocks
///    times in it; which friction begins is the row that others used least, drawn as the pictures
///    are (stream friction_blocks). Only the limit of objects applies.
/// 3. Catch trials among them, at places drawn uniformly from all but the first (stream
///    catch_trials). (Friction blocks: each among trials of its own friction, and first in no
///    block.) They cycle over catch objects x frictions, so that each object and each friction
///    comes as equally often as their number allows. They do not count for the run limits: these
///    hold for the main trials as if the catch trials were not there, else the limits would bend
///    where they fall.
/// 4. A break before every break_every-th of the main and catch trials together, and before the
///    first of them if there was practice.
/// 5. Pictures: the row of the Williams design that others used least, ties drawn by the stream
///    pictures, whose key leaves the session out: a participant sees one order in all sessions.
///
/// @param protocol_hash  protocol_hash(protocol)
/// @param seed           the study seed: protocol.seed unless the operator gave another
/// @param pictures       who already ran with which row of picture_rows()
/// @param frictions      who already ran with which row of friction_rows(); only for friction
/// blocks
/// @throws OrderError if no order keeps the run limits
/// @throws std::invalid_argument if there is nothing to run (no pictured object, friction or
///         repetition, catch trials without a catch object; no protocol read from a file is like
///         that), if friction blocks cannot be had (why_not_in_blocks), if `blocks` does not divide
///         the repetitions, or if first_order is asked for with catch trials, several blocks, or
///         other repetitions than conditions
[[nodiscard]] Plan make_plan(const Protocol& protocol,
                             std::string_view protocol_hash,
                             const SessionKey& key,
                             std::uint64_t seed,
                             const RowHistory& pictures = {},
                             const RowHistory& frictions = {});

/// Short code of the plan for the lab book: the first 32 bits of its hash, as in "3f9a-01bc". Noted
/// before the first trial it says later which order was meant: `palpate sequence` and `palpate run`
/// show it. Another plan of the same study has the same code once in 4 billion.
[[nodiscard]] std::string session_code(const Plan& plan);

}  // namespace palpate::protocols
