#pragma once

#include "engine/device/drivers/board_line.hpp"
#include "engine/device/open/open_wire.hpp"

namespace palpate::engine {

/// The talk with an open board. Answers carry the number of their question: one that is lost keeps
/// no other one from being heard, and an old one is dropped.
///
/// The board switches its motors off when no torque comes for OpenWiring::watchdog, also while
/// nothing ticks: wake() arms it again, unless the emergency stop was pressed. That waits for
/// forgive().
class OpenLine : public BoardLine {
public:
    /// @param link  outlives the line
    /// @throws std::invalid_argument for a wiring that cannot be
    OpenLine(ByteLink& link, const OpenWiring& wiring, const Calibration& machine);

    /// Hello for up to three seconds, since opening a port resets many boards; is it the board of
    /// the calibration; limits and watchdog, which it must repeat to the byte; then for 0.2 s: does
    /// its clock run, do its counts rest, is the emergency stop released. Motors stay off.
    [[nodiscard]] Answer set_up() noexcept override;
    [[nodiscard]] std::string refusal() const override;
    [[nodiscard]] std::string complaint() const override;
    /// Torque 0, three times DISARM, then listens.
    [[nodiscard]] bool silence() noexcept override;
    void keep_off() noexcept override;
    [[nodiscard]] bool forgive() noexcept override;
    [[nodiscard]] Answer wake(std::int64_t wait_ns) noexcept override;
    [[nodiscard]] bool ask(const std::array<double, kMaxAxes>& torque) noexcept override;
    /// Never: its answers are distinguished, and one that was lost must not end the talk.
    [[nodiscard]] bool full(std::size_t /*depth*/) const noexcept override { return false; }
    [[nodiscard]] Answer hear(std::int64_t wait_ns, std::size_t leave) noexcept override;
    [[nodiscard]] Answer probe(std::int64_t wait_ns) noexcept override;
    void start_over() noexcept override;

    [[nodiscard]] GuardPackets guard_packets() const noexcept override;
    [[nodiscard]] double holds_force() const noexcept override { return wiring_.watchdog; }
    [[nodiscard]] std::string kind() const override { return "open board"; }
    [[nodiscard]] std::string identity() const override;

    /// What the board said it is, since set_up().
    [[nodiscard]] const OpenIdent& ident() const noexcept { return ident_; }

private:
    /// What keeps a board from being used.
    enum class Problem : std::uint8_t {
        none,
        silent,
        other_device,
        version,
        id,
        axes,
        counts,
        torque,
        watchdog,
        config,
        clock,
        moves,
        stop_pressed,
        was_reset,
        watchdog_fired,
        skipped_edge,
        jump,
        other_host,
    };

    [[nodiscard]] bool send(const BoardBytes& body) noexcept;
    [[nodiscard]] BoardBytes packed(const BoardBytes& body) const noexcept;
    [[nodiscard]] std::uint16_t next_seq() noexcept;
    [[nodiscard]] std::optional<OpenAnswer> call(const BoardBytes& body,
                                                 std::int64_t wait_ns) noexcept;
    [[nodiscard]] std::optional<OpenAnswer> next_answer(std::int64_t wait_ns) noexcept;
    [[nodiscard]] std::optional<OpenAnswer> opened(std::span<const std::uint8_t> datagram) noexcept;
    void forget() noexcept;
    [[nodiscard]] bool greet() noexcept;
    [[nodiscard]] Problem wrong_board() const noexcept;
    [[nodiscard]] std::string other_machine() const;
    [[nodiscard]] Problem agree() noexcept;
    [[nodiscard]] Problem look() noexcept;
    [[nodiscard]] Problem look_once() noexcept;
    [[nodiscard]] Answer take(const OpenReport& report) noexcept;
    [[nodiscard]] Answer obeys(OpenType order, std::int64_t wait_ns) noexcept;
    [[nodiscard]] Answer fail(Problem problem, Answer answer) noexcept;

    OpenWiring wiring_;
    std::size_t axes_;                     ///< of the machine
    bool bare_;                            ///< a body a datagram, without a frame
    OpenNonce nonce_{};                    ///< that every datagram begins with
    OpenAxes counts_per_turn_{};           ///< by channel
    OpenAxes limit_{};                     ///< uN m, by channel
    std::array<double, kMaxAxes> jump_{};  ///< counts between two answers that cannot be, by axis
    BoardBytes disarm_;
    OpenReader reader_;
    std::array<std::uint8_t, 256> came_{};
    std::size_t came_at_ = 0;
    std::size_t came_size_ = 0;
    bool lost_ = false;   ///< the link is
    bool noise_ = false;  ///< bytes came at the opening
    OpenIdent ident_{};
    OpenConfig config_{};
    OpenReport report_{};
    bool reported_ = false;  ///< report_ is of this set-up
    Problem problem_ = Problem::none;
    bool waking_ = false;
    std::uint16_t seq_ = kGuardSeq;    ///< of the latest question
    std::uint16_t heard_ = kGuardSeq;  ///< of the newest answer
};

/// @throws std::invalid_argument if the calibration has no [board], or one that cannot be
[[nodiscard]] std::unique_ptr<BoardLine> open_line(ByteLink& link, const Calibration& calibration);

}  // namespace palpate::engine
