#pragma once

#include "engine/base/clock.hpp"
#include "engine/device/calibration.hpp"
#include "tests/support/std.hpp"

namespace palpate::tests {

/// In a child, first of all: ends it when `parent` ends, however that comes (a crash, ctest's
/// time-out).
void die_with(pid_t parent);

/// Runs `work` in a child process, which ends after it. @return its id, to be killed and reaped
[[nodiscard]] pid_t in_a_child(const std::function<void()>& work);

/// The processes that `parent` has started and that still run.
/// @param name  stands in each one's line of /proc/PID/stat
[[nodiscard]] std::vector<pid_t> children_of(pid_t parent, std::string_view name = "");

/// The guard that `palpate` has started; -1: there is none.
[[nodiscard]] pid_t guard_of(pid_t palpate);

void wait_a_little(int ms = 1);

/// How long a test waits for what must come: 50 s, or PALPATE_TEST_PATIENCE (one that must fail).
[[nodiscard]] std::int64_t patience_ns();

/// Lets up to patience_ns() pass until `done`, and looks less and less often, up to every 8 ms: who
/// looks on keeps no board from its turn. @return done
template <class Done>
bool eventually(const Done& done) {
    const std::int64_t end = monotonic_ns() + patience_ns();
    for (int looks = 0; monotonic_ns() < end; ++looks) {
        if (done()) {
            return true;
        }
        wait_a_little(std::min(1 + looks / 10, 8));
    }
    return done();
}

/// Where a busy machine may spoil a try: up to `tries`, until one is right. @return one was
template <class Try>
bool tried(int tries, const Try& one) {
    return std::ranges::any_of(std::views::iota(0, tries), [&](int) { return one(); });
}

/// A process that drives the board at a port with a constant force at 1 kHz until something ends
/// it. Start it before threads.
class Presser {
public:
    /// What ends it, besides signals.
    enum class End { signal, hang };

    Presser(const std::string& path,
            const engine::Calibration& calibration,
            const engine::Vec2& force,
            End end = End::signal);
    Presser(const Presser&) = delete;
    Presser& operator=(const Presser&) = delete;
    ~Presser();

    void signal(int number) const;
    /// Now the hang begins.
    void end();
    /// Waits for the end of the process, and reaps it.
    void reap();
    /// The first fault that its device reported, as a number; 0: none yet.
    [[nodiscard]] int fault() const;
    /// Process id of the guard, 0 before there is one.
    [[nodiscard]] pid_t guard() const;
    [[nodiscard]] pid_t id() const { return pid_; }

    struct Shared;

private:
    Shared* shared_ = nullptr;
    pid_t pid_ = -1;
};

/// One that presses, at last. Where the machine is so busy that its guard or the board took its
/// force before anybody saw it, another one begins.
template <class Board>
std::unique_ptr<Presser> pressing(const Board& board,
                                  const engine::Calibration& calibration,
                                  Presser::End end = Presser::End::signal) {
    for (int attempt = 0; attempt < 20; ++attempt) {
        auto presser =
            std::make_unique<Presser>(board.path(), calibration, engine::Vec2{0.4, -0.5}, end);
        const bool over =
            eventually([&] { return !board.motors().off() || presser->fault() != 0; });
        if (over && presser->fault() == 0) {
            return presser;
        }
    }
    throw std::runtime_error("nothing ever pressed");
}

}  // namespace palpate::tests
