#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/clock.hpp"
#include "engine/device/calibration.hpp"
#include "engine/device/device.hpp"
#include "engine/device/drivers/byte_link.hpp"
#include "engine/device/drivers/motor_guard.hpp"

namespace palpate::engine {

/// What a board measured.
struct BoardReply {
    /// Of pivot 1 and 2, anticlockwise, or of x, y and z, since its set-up.
    std::array<std::int32_t, kMaxAxes> counts{};
    Grip grip = Grip::unknown;
};

/// The talk with one board over a link, in the board's own language: set-up, questions that carry
/// torques, answers that carry counts, silence. What is used in the tick is noexcept and allocates
/// nothing.
class BoardLine {
public:
    enum class Answer : std::uint8_t {
        pending,   ///< nothing new enough has come yet
        complete,  ///< the newest answer is in reply(); or nothing was asked
        garbage,   ///< what cannot be
        lost,      ///< the link is gone, or the board was reset and has forgotten where it was
        stopped,   ///< the board has switched its motors off by itself
    };

    /// An answer that is older is from before a rest, ns.
    static constexpr std::int64_t kStale = 100 * kMillisecond;
    /// How often keep_off() says that the motors are to be off, ns.
    static constexpr std::int64_t kAgain = 20 * kMillisecond;

    /// @param link  outlives the line
    explicit BoardLine(ByteLink& link) : link_(&link) {}
    BoardLine(const BoardLine&) = delete;
    BoardLine& operator=(const BoardLine&) = delete;
    virtual ~BoardLine() = default;

    /// Makes the board ready, motors off, whatever it was at; the present pose becomes count 0.
    /// @return complete if it answered as it should; refusal() says why not
    [[nodiscard]] virtual Answer set_up() noexcept = 0;
    /// Why set_up() failed: a sentence with the remedy.
    [[nodiscard]] virtual std::string refusal() const = 0;
    /// What is wrong by the board's own words since then, with the remedy; empty: it said nothing.
    [[nodiscard]] virtual std::string complaint() const { return {}; }
    /// Switches the motors off, and listens. @return true if the board acknowledged
    [[nodiscard]] virtual bool silence() noexcept = 0;
    /// How surely the motors are off.
    enum class Off : std::uint8_t {
        unproved,  ///< no whole answer came to zero torque
        proved,    ///< the board acknowledged it
        anew,      ///< the same, after a new set-up: where it counted from is lost
    };
    /// Silence by all means that there are: the last words to a board, and after a trip.
    virtual Off part() noexcept { return silence() ? Off::proved : Off::unproved; }
    /// Every millisecond while the motors have to stay off and nobody asks: says so again every 20
    /// ms, and at once when something answers that was not asked.
    virtual void keep_off() noexcept = 0;
    /// Takes back what made the board stop. @return false while that lasts
    [[nodiscard]] virtual bool forgive() noexcept { return true; }

    /// Before the first question after a rest: what is still on its way is too old. A board that
    /// switched its motors off meanwhile is made ready again. Takes little more than `wait_ns`.
    /// @return complete: reply() is new
    [[nodiscard]] virtual Answer wake(std::int64_t wait_ns) noexcept = 0;
    /// Sends torques of all motors, N m, anticlockwise or forward. @return false if they were not
    /// sent whole, before a set-up, or if they are not finite
    [[nodiscard]] virtual bool ask(const std::array<double, kMaxAxes>& torque) noexcept = 0;
    /// With `depth` questions on their way another one would make answers older.
    [[nodiscard]] virtual bool full(std::size_t depth) const noexcept { return owed_ >= depth; }
    /// Collects all that has come, and waits at most `wait_ns` for more while more than `leave`
    /// answers are still to come.
    [[nodiscard]] virtual Answer hear(std::int64_t wait_ns, std::size_t leave) noexcept = 0;
    /// A question that gives no torque, and its answer. @return complete: reply() is new
    [[nodiscard]] virtual Answer probe(std::int64_t wait_ns) noexcept = 0;
    /// The link was opened anew: nothing is known of the board behind it.
    virtual void start_over() noexcept = 0;

    /// For whoever guards the port.
    [[nodiscard]] virtual GuardPackets guard_packets() const noexcept = 0;
    /// How long the board keeps the last force when nobody speaks to it, s.
    [[nodiscard]] virtual double holds_force() const noexcept = 0;
    /// "Haply"
    [[nodiscard]] virtual std::string kind() const = 0;
    /// Device::identity(), since set_up().
    [[nodiscard]] virtual std::string identity() const { return {}; }

    /// The newest answer that was whole and as expected; before the first one, empty.
    [[nodiscard]] const BoardReply& reply() const noexcept { return reply_; }
    /// An answer is still to come.
    [[nodiscard]] bool awaiting() const noexcept { return owed_ > 0; }
    /// So many questions are younger than reply().
    [[nodiscard]] std::size_t owed() const noexcept { return owed_; }
    /// Since when the next answer is due, ns on the link's clock.
    [[nodiscard]] std::int64_t owed_since_ns() const noexcept { return owed_since_ns_; }
    /// When the latest question was asked, ns on the link's clock.
    [[nodiscard]] std::int64_t asked_ns() const noexcept { return asked_ns_; }
    [[nodiscard]] bool is_set_up() const noexcept { return set_up_; }
    /// Probes one time after the other and takes the middle one of the times until their answers.
    /// @param times  at most 64   @return s; none if an answer stayed away for 100 ms
    [[nodiscard]] std::optional<double> round_trip(std::size_t times) noexcept {
        std::array<std::int64_t, 64> took{};
        const std::size_t all = std::min(times, took.size());
        for (std::size_t i = 0; i < all; ++i) {
            if (probe(100 * kMillisecond) != Answer::complete) {
                return std::nullopt;
            }
            took[i] = link_->now_ns() - asked_ns_;
        }
        std::sort(took.begin(), took.begin() + static_cast<std::ptrdiff_t>(all));
        return static_cast<double>(took[all / 2]) * 1e-9;
    }

protected:
    ByteLink* link_;
    BoardReply reply_{};
    std::size_t owed_ = 0;  ///< answers still to come
    std::int64_t owed_since_ns_ = 0;
    std::int64_t asked_ns_ = 0;
    bool set_up_ = false;
};

/// Makes the line of a board. @throws std::invalid_argument if the calibration says nothing of such
/// a board
using MakeLine = std::unique_ptr<BoardLine> (*)(ByteLink&, const Calibration&);

}  // namespace palpate::engine
