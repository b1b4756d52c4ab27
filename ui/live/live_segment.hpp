#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "ui/rig/control_line.hpp"

/// What a running session shows to other programs: shared memory with one writer, that neither
/// waits for a reader nor hears of one. It has no name: whoever may call the session's control
/// socket gets it from there, can only read it, and nothing of it is left when the session ends.
namespace palpate::ui {

/// A tick as it is shown. Until what is felt is revealed all of it but the time, the lateness and
/// whether there may be force is 0.
struct LiveTick {
    engine::TickRecord tick{};
    double speed = 0.0;  ///< m/s, of HIP since the one that was shown before
    bool force_on = false;
    bool felt = false;  ///< what is felt is in here
    std::array<std::uint8_t, 6> unused{};
};
static_assert(sizeof(LiveTick) == sizeof(engine::TickRecord) + 16);

struct LiveMemory;
struct Unmap {
    void operator()(const LiveMemory* memory) const noexcept;
};

/// The session's side.
class LiveWriter {
public:
    /// 4 s of ticks at 125 Hz.
    static constexpr std::size_t kRing = 500;
    static constexpr std::size_t kStateRoom = 1U << 17U;  ///< bytes

    /// A system that gives no memory: nothing is shown, and that is no error.
    LiveWriter() noexcept;

    /// To be handed on; whoever has it can only read. < 0: none.
    [[nodiscard]] int descriptor() const noexcept { return file_.get(); }
    /// @param state  JSON; one that is too long is not shown
    /// @param phase_ns  when its phase began, CLOCK_MONOTONIC
    void show(std::string_view state, std::int64_t phase_ns) noexcept;
    void show(const LiveTick& tick) noexcept;
    /// The session looks what is asked of it.
    void answers() noexcept;

private:
    Descriptor file_;
    std::unique_ptr<LiveMemory, Unmap> memory_;
};

/// What was read.
struct LiveState {
    std::string json;  ///< empty: nothing yet
    std::int64_t phase_ns = 0;
};

/// Another program's side; also the session's own, for its other threads.
class LiveReader {
public:
    /// @throws std::runtime_error if that is no live state of this version of palpate
    explicit LiveReader(int descriptor);

    /// Changes with each state.
    [[nodiscard]] std::uint64_t version() const noexcept;
    /// When the session last looked what is asked of it, CLOCK_MONOTONIC; 0: not yet.
    [[nodiscard]] std::int64_t answered_ns() const noexcept;
    /// A whole state, never half of one; none: it was always being written.
    [[nodiscard]] std::optional<LiveState> state() const;
    /// Those that came after the first `seen` of all, oldest first, and how many there were then.
    [[nodiscard]] std::pair<std::vector<LiveTick>, std::uint64_t> ticks_after(
        std::uint64_t seen) const;

private:
    std::unique_ptr<const LiveMemory, Unmap> memory_;
};

/// A session that runs now on this machine, and shows itself to this user.
struct RunningSession {
    std::string name;  ///< of its control socket
    std::string file;  ///< its database
    std::string uuid;
    Descriptor process;  ///< a pidfd: of this one, and of no other that gets its number
    std::unique_ptr<LiveReader> reader;

    [[nodiscard]] bool alive() const { return !readable(process.get(), 0); }
};

/// @param of  a database, or a session's uuid; none: all
[[nodiscard]] std::vector<RunningSession> running_sessions(const std::optional<std::string>& of);

}  // namespace palpate::ui
