#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <sys/types.h>

#include "engine/device/calibration.hpp"
#include "engine/device/drivers/board_device.hpp"
#include "engine/device/drivers/guard_process.hpp"
#include "engine/device/emulator/haply_board.hpp"
#include "engine/device/hand_path.hpp"

namespace palpate::engine {

/// A plant whose handle a simulated hand holds.
class BoardHand : public BoardPlant {
public:
    /// Puts the handle at the start and explores. Until the first one, and again after each set-up,
    /// the handle rests at Exploration's own start.
    /// @throws std::invalid_argument if the start is out of reach
    virtual void begin(const Exploration& plan) = 0;
    /// The exploration has come to its end.
    [[nodiscard]] virtual bool hand_is_done() const noexcept = 0;
};

/// Any plant with begin, set_torque, advance, angles and hand_is_done as the hand on a board.
template <class Plant>
class HandOf : public BoardHand {
public:
    /// @param arguments  of the plant, which stands where its exploration begins
    template <class... Arguments>
    explicit HandOf(const Arguments&... arguments) : plant_(arguments...), at_rest_(plant_) {
        at_rest_.begin({.tremor = 0.0});  // exactly at its start
        plant_ = at_rest_;
    }

    void begin(const Exploration& plan) override {
        plant_.begin(plan);
        begun_ = true;
    }
    void set_torque(const Vec3& newton_metres) noexcept override {
        plant_.set_torque(Vec2(newton_metres));
    }
    void advance(double seconds) noexcept override {
        if (begun_) {
            plant_.advance(seconds);
        }
    }
    [[nodiscard]] double angle(std::size_t axis) const noexcept override {
        return plant_.angles()[axis];
    }
    [[nodiscard]] bool hand_is_done() const noexcept override { return plant_.hand_is_done(); }
    /// Whoever plugs a board in again puts the handle back first.
    void before_set_up() noexcept override {
        plant_ = at_rest_;
        begun_ = false;
    }

private:
    Plant plant_;
    Plant at_rest_;
    bool begun_ = false;
};

/// Names this process and, where that is permitted, lets it run before others: a real board is
/// never kept waiting by what else its host does.
void run_like_a_board() noexcept;

/// Makes the hand that holds the handle of an emulated board.
using MakeHand = std::function<std::unique_ptr<BoardHand>()>;
/// Makes the board of a machine, whose motors and encoders hang on a plant.
using MakeBoard = std::unique_ptr<PortBoard> (*)(BoardPlant&, const Calibration&);
/// @throws std::invalid_argument without [haply]
[[nodiscard]] std::unique_ptr<PortBoard> make_haply_board(BoardPlant& plant,
                                                          const Calibration& machine);
/// @throws std::invalid_argument without [board]
[[nodiscard]] std::unique_ptr<PortBoard> make_open_board(BoardPlant& plant,
                                                         const Calibration& machine);

/// The board emulator as a process of its own on a pseudo-terminal: it outlives a host that is
/// killed, and shows what its motors do. Make it before threads (it is forked without exec). It
/// ends with this object, or with the process that made it.
class EmulatedBoard {
public:
    /// @param machine  the calibration that is true of the emulated machine
    /// @param hand     makes the plant, in the new process
    /// @param link     see PtyBoard; needed for plug()
    /// @throws std::runtime_error if it does not start
    EmulatedBoard(const Calibration& machine,
                  const MakeHand& hand,
                  const std::string& link = {},
                  MakeBoard make_board = make_haply_board);
    EmulatedBoard(const EmulatedBoard&) = delete;
    EmulatedBoard& operator=(const EmulatedBoard&) = delete;
    ~EmulatedBoard();

    /// What the motors get now, N m, and since when, CLOCK_MONOTONIC ns.
    struct Motors {
        Vec2 torque{};
        std::int64_t since_ns = 0;
        /// No motor has a torque.
        [[nodiscard]] bool off() const noexcept { return torque == Vec2{}; }
    };

    /// The pseudo-terminal, for a driver to open.
    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    /// The motors as they are now.
    [[nodiscard]] Motors motors() const noexcept;
    /// What has happened on a Haply board since it began.
    [[nodiscard]] BoardLog journal() const noexcept;
    /// Tells the hand to explore. Returns when it has begun.
    /// @throws std::invalid_argument if the start is out of reach
    void begin(const Exploration& plan);
    [[nodiscard]] bool hand_is_done() const noexcept;
    /// Returns when the plug is out or in. @throws std::runtime_error if that takes too long
    void plug(bool in);
    /// From now on the board answers nothing, or answers again.
    void hush(bool silent);
    /// Somebody presses the emergency stop, or releases it.
    void press_stop(bool pressed);
    [[nodiscard]] pid_t id() const noexcept { return pid_; }

    struct Shared;

private:
    void end() noexcept;
    void await(const std::function<bool()>& done, const char* what) const;

    Shared* shared_ = nullptr;
    std::string path_;
    pid_t pid_ = -1;
};

/// A port, its driver and its guard: what `--device haply:PATH` is.
/// @throws as BoardDevice
[[nodiscard]] std::unique_ptr<BoardDevice> open_haply(const std::string& path,
                                                      const Calibration& calibration,
                                                      const BoardTiming& timing = {},
                                                      const GuardTiming& guard = {});

/// The same of an open board: what `--device board:PATH` is.
[[nodiscard]] std::unique_ptr<BoardDevice> open_board(const std::string& path,
                                                      const Calibration& calibration,
                                                      const BoardTiming& timing = {},
                                                      const GuardTiming& guard = {});

/// An emulated board with a simulated hand on it, and the driver that speaks to it over a real
/// port: two processes beside this one, board and guard. Make it before threads.
class EmulatedHaply {
public:
    /// @param hand  makes the plant in the board's process; its linkage and frame are those of
    ///              `calibration`
    /// @param link  see PtyBoard; needed to unplug the board
    EmulatedHaply(const Calibration& calibration,
                  const MakeHand& hand,
                  const BoardTiming& timing = {},
                  const GuardTiming& guard = {},
                  const std::string& link = {})
        : board_(calibration, hand, link),
          device_(open_haply(board_.path(), calibration, timing, guard)) {}

    /// Before a trial: the handle is at the start, and the hand sets off.
    /// @throws std::invalid_argument if the start is out of reach
    void begin(const Exploration& plan) {
        board_.begin(plan);
        device_->expect_move();
    }
    [[nodiscard]] bool hand_is_done() const noexcept { return board_.hand_is_done(); }
    [[nodiscard]] BoardDevice& device() noexcept { return *device_; }
    [[nodiscard]] const BoardDevice& device() const noexcept { return *device_; }
    [[nodiscard]] EmulatedBoard& board() noexcept { return board_; }

private:
    EmulatedBoard board_;
    std::unique_ptr<BoardDevice> device_;
};

}  // namespace palpate::engine
