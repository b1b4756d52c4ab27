#pragma once

#include <functional>
#include <string>

#include <sys/types.h>

#include "engine/device/calibration.hpp"

namespace palpate::tests {

/// A process that drives the board at a port with a constant force at 1 kHz until something ends it.
/// Start it before threads.
class Presser {
public:
    /// What ends it, besides signals.
    enum class End { signal, exception, hang };

    Presser(const std::string& path,
            const engine::Calibration& calibration,
            const engine::Vec2& force,
            End end = End::signal);
    Presser(const Presser&) = delete;
    Presser& operator=(const Presser&) = delete;
    ~Presser();

    void signal(int number) const;
    /// Now the exception is thrown, or the hang begins.
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

/// Runs `work` in a child process, which ends after it. @return its id, to be killed and reaped
[[nodiscard]] pid_t in_a_child(const std::function<void()>& work);

/// Lets up to 20 s pass until `done`. @return done
template <class Done>
bool eventually(const Done& done);

/// 1 ms.
void wait_a_little();

template <class Done>
bool eventually(const Done& done) {
    for (int waited = 0; waited < 20'000; ++waited) {
        if (done()) {
            return true;
        }
        wait_a_little();
    }
    return done();
}

}  // namespace palpate::tests
