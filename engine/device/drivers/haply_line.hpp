#pragma once

#include <limits>

#include "engine/device/drivers/board_line.hpp"
#include "engine/device/drivers/haply_wire.hpp"

namespace palpate::engine {

/// The talk with a Haply board. It keeps these rules, whatever happens: no exchange before a
/// set-up, whole packets only, and one packet after the other. Answers come in the order of their
/// questions: one that is behind keeps no other one from being heard. Part of an answer is kept.
class HaplyLine : public BoardLine {
public:
    /// @param link  outlives the line
    HaplyLine(ByteLink& link, const HaplyWiring& wiring, const PantographSpec& pantograph);

    /// Zero torque to each address that a board may have, reset, set-up, and three zero exchanges
    /// that must be answered: a set-up itself never is. A reset takes the motors' addresses and
    /// leaves their torque. Takes up to half a second.
    [[nodiscard]] Answer set_up() noexcept override;
    [[nodiscard]] std::string refusal() const override;
    /// Zero torque five times, 1 ms apart, then listens.
    [[nodiscard]] bool silence() noexcept override;
    /// A board that does not answer zero torque is set up anew, and gets it again.
    Off part() noexcept override;
    void keep_off() noexcept override;
    [[nodiscard]] Answer wake(std::int64_t wait_ns) noexcept override;
    [[nodiscard]] bool ask(const std::array<double, kMaxAxes>& torque) noexcept override;
    [[nodiscard]] Answer hear(std::int64_t wait_ns, std::size_t leave) noexcept override;
    [[nodiscard]] Answer probe(std::int64_t wait_ns) noexcept override;
    void start_over() noexcept override;

    [[nodiscard]] GuardPackets guard_packets() const noexcept override;
    /// For ever: it has no watchdog.
    [[nodiscard]] double holds_force() const noexcept override {
        return std::numeric_limits<double>::infinity();
    }
    [[nodiscard]] std::string kind() const override { return "Haply"; }

private:
    [[nodiscard]] bool introduce() noexcept;
    [[nodiscard]] bool take_reply() noexcept;
    [[nodiscard]] bool is_whole(double angle_deg, std::size_t port) const noexcept;
    [[nodiscard]] bool id_alone(std::size_t came) noexcept;
    void forget() noexcept;
    void forget_backlog() noexcept;

    HaplyWiring wiring_;
    HaplySetup setup_;
    BoardBytes reset_packet_;
    BoardBytes setup_packet_;
    BoardBytes zero_;
    std::size_t reply_size_;
    Answer last_set_up_ = Answer::complete;
    std::array<std::uint8_t, 256> kept_{};  ///< bytes of answers not yet complete
    std::size_t kept_size_ = 0;
    std::int64_t alone_since_ns_ = 0;  ///< that an id without the rest of its answer is kept
};

/// @throws std::invalid_argument if the calibration has no [haply], or one that cannot be
[[nodiscard]] std::unique_ptr<BoardLine> haply_line(ByteLink& link, const Calibration& calibration);

}  // namespace palpate::engine
