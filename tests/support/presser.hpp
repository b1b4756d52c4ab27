#pragma once

#include "engine/device/calibration.hpp"
#include "tests/support/child.hpp"

namespace palpate::tests {

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

}  // namespace palpate::tests
