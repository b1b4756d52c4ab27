#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "engine/device/drivers/byte_link.hpp"
#include "engine/device/drivers/haply_wire.hpp"

namespace palpate::engine {

/// The talk with one board over a link: set-up, exchanges, silence. It keeps these rules, whatever
/// happens: no exchange before a set-up, whole packets only, and one packet after the other.
class HaplyLine {
public:
    enum class Answer : std::uint8_t {
        pending,   ///< nothing new has come yet
        complete,  ///< the newest answer that has come is in reply(); or nothing was asked
        garbage,   ///< wrong id, impossible numbers, or more than was asked for
        lost,      ///< the link is gone
    };

    /// @param link  outlives the line
    HaplyLine(ByteLink& link, const HaplySetup& setup);

    /// Reset, set-up, and three zero exchanges that must be answered: a set-up itself never is. A
    /// reset takes the motors' addresses and leaves their torque, so silence() comes before. Takes
    /// up to half a second. It makes the present pose count 0. @return complete if they were
    [[nodiscard]] Answer set_up() noexcept;

    /// Zero torque five times, 1 ms apart, then listens. @return true if the board acknowledged
    bool silence() noexcept;

    /// Sends an exchange. @return false if it was not sent whole, before a set-up or for a torque
    /// that is not finite
    [[nodiscard]] bool ask(const std::array<double, 2>& torque) noexcept;

    /// Collects all that has come, and waits at most `wait_ns` for more while more than `leave`
    /// answers are still to come. Answers come in the order of their questions: one that is behind
    /// keeps no other one from being heard. Part of an answer is kept.
    [[nodiscard]] Answer hear(std::int64_t wait_ns, std::size_t leave = 0) noexcept;

    /// Throws away what has come, and expects nothing more: an answer that is still on its way
    /// would be taken for that to the next question.
    void forget() noexcept;

    [[nodiscard]] const HaplyReply& reply() const noexcept { return reply_; }
    /// An answer is still to come.
    [[nodiscard]] bool awaiting() const noexcept { return owed_ > 0; }
    /// How many answers are still to come.
    [[nodiscard]] std::size_t owed() const noexcept { return owed_; }
    /// Asks one zero question after the other, `times` of them, and takes the middle one of the times
    /// until their answers. @return s; none if one stayed away for 100 ms
    [[nodiscard]] std::optional<double> round_trip(std::size_t times) noexcept;
    /// Since when the next answer is due, ns on the link's clock.
    [[nodiscard]] std::int64_t owed_since_ns() const noexcept { return owed_since_ns_; }
    /// When the latest question was asked, ns on the link's clock.
    [[nodiscard]] std::int64_t asked_ns() const noexcept { return asked_ns_; }
    [[nodiscard]] bool is_set_up() const noexcept { return set_up_; }
    /// The link was opened anew: nothing is known of the board behind it.
    void start_over() noexcept;

    [[nodiscard]] const HaplyPacket& zero() const noexcept { return zero_; }
    [[nodiscard]] const HaplyPacket& introduction() const noexcept { return setup_packet_; }

private:
    [[nodiscard]] bool introduce() noexcept;
    [[nodiscard]] bool take_reply() noexcept;

    ByteLink* link_;
    HaplySetup setup_;
    HaplyPacket reset_packet_;
    HaplyPacket setup_packet_;
    HaplyPacket zero_;
    std::size_t reply_size_;
    HaplyReply reply_{};
    std::array<std::uint8_t, 256> kept_{};  ///< bytes of answers not yet complete
    std::size_t kept_size_ = 0;
    std::size_t owed_ = 0;  ///< answers still to come
    std::int64_t owed_since_ns_ = 0;
    std::int64_t asked_ns_ = 0;
    bool set_up_ = false;
};

}  // namespace palpate::engine
