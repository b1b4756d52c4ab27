#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/pcg32.hpp"

namespace palpate::protocols {

/// What a stream of random numbers is for. Two keys that differ anywhere give independent streams,
/// so that asking for more catch trials never changes the order of the pictures.
struct StreamKey {
    std::string protocol_hash;  ///< protocol_hash(protocol)
    std::string participant;
    std::size_t session = 1;  ///< 0: the same for all sessions of the participant
    std::size_t block = 0;    ///< e.g. the position of a trial
    std::string purpose;      ///< one of purpose::
    std::uint64_t seed = 0;   ///< the recorded study seed
    /// Random, of the file that the session is in, and never handed on with its data: all else can
    /// be known or guessed, and an order that anybody can compute says whose it is. Empty: an
    /// example, of no file.
    std::string secret{};
};

/// Everything that is drawn at random in a session, and what its key says besides protocol,
/// participant and seed. Whoever draws something new adds a purpose here: two that share one share
/// their numbers.
namespace purpose {
inline constexpr std::string_view practice_order = "order.practice";  ///< session
inline constexpr std::string_view main_order = "order.main";  ///< session, block of main trials
inline constexpr std::string_view catch_trials = "catch";     ///< session; conditions, then places
inline constexpr std::string_view pictures =
    "pictures";  ///< session 0: the row of the Williams design
inline constexpr std::string_view friction_blocks =
    "friction_blocks";                            ///< session 0: which friction begins
inline constexpr std::string_view hand = "hand";  ///< session, block = position: simulated hand
inline constexpr std::string_view observer =
    "observer";                                         ///< session, block = position: its answers
inline constexpr std::string_view requeue = "requeue";  ///< session, block = position: place of the
                                                        ///< 1st, 2nd, ... repetition
inline constexpr std::string_view masking = "masking";  ///< session: noise on the headphones
inline constexpr std::string_view second_hand = "hand.second";  ///< as hand, in the second interval
inline constexpr std::string_view procedure = "procedure";      ///< session, block = run, from 0
inline constexpr std::string_view person = "person";  ///< session 0: who a simulated participant is
/// Nobody's, session 0, block = which set of rows: the order in which simulated participants take
/// them.
inline constexpr std::string_view rows = "rows";
inline constexpr std::string_view friction_rows = "rows.friction";  ///< the same of friction blocks
inline constexpr std::array all = {
    practice_order, main_order, catch_trials, pictures,  friction_blocks, hand, observer,
    requeue,        masking,    second_hand,  procedure, person,          rows, friction_rows};
}  // namespace purpose

/// The text that is hashed: one `name=value` a line, that of an empty secret left out. Texts carry
/// their length in bytes, so that no participant's name can pass for another key.
[[nodiscard]] std::string canonical_text(const StreamKey& key);

/// Where a stream begins: the first 16 bytes of SHA-256(canonical text), as 32 hexadecimal digits.
/// It gives this stream away and nothing else: no other one, nor whose it is.
[[nodiscard]] std::string stream_origin(const StreamKey& key);
/// The stream that begins there. @pre 32 hexadecimal digits
[[nodiscard]] Pcg32 stream_from(std::string_view origin);

/// The stream of `key`: bytes 0-7 of SHA-256(canonical text), big-endian, are the generator's
/// initstate and bytes 8-15 its initseq.
[[nodiscard]] Pcg32 stream(const StreamKey& key);
/// The stream of the same key for another purpose and block.
[[nodiscard]] Pcg32 stream(StreamKey key, std::string_view purpose, std::size_t block = 0);

}  // namespace palpate::protocols
