#pragma once

#include <linux/input.h>
#include <sys/stat.h>
#include <termios.h>

#include "tests/support/pressed_desk.hpp"

// What ends a force without the window's focus: the experimenter's terminal, and a pipe in place of
// a button.

namespace palpate::tests {

inline void written(ssize_t bytes) {
    if (bytes <= 0) {
        throw std::runtime_error("could not write");
    }
}

/// The experimenter's terminal: a pseudo-terminal whose other end types.
class Terminal {
public:
    Terminal() : typist_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        grantpt(typist_);
        unlockpt(typist_);
        name_ = ptsname(typist_);
        kept_ = open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
        before_ = mode();
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    ~Terminal() {
        close(kept_);
        close(typist_);
    }
    void type(const char* keys) const { written(::write(typist_, keys, std::strlen(keys))); }
    [[nodiscard]] bool as_before() const {
        const termios now = mode();
        return std::memcmp(now.c_cc, before_.c_cc, sizeof now.c_cc) == 0 &&
               now.c_lflag == before_.c_lflag && now.c_iflag == before_.c_iflag;
    }
    /// Ctrl+S keeps back what is said to it, and its speaker.
    [[nodiscard]] bool can_be_held() const { return (mode().c_iflag & IXON) != 0; }
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    [[nodiscard]] termios mode() const {
        termios now{};
        tcgetattr(kept_, &now);
        return now;
    }
    int typist_;
    int kept_ = -1;
    std::string name_;
    termios before_{};
};

/// A pipe in place of a button. A process of its own keeps it open: a child of the test would go on
/// doing so.
class StopButton {
public:
    explicit StopButton(std::string file) : file_(std::move(file)) {
        mkfifo(file_.c_str(), 0600);
        plug_in();
    }
    void plug_in() {
        holder_ =
            std::make_unique<tests::Process>(Words{"sh", "-c", "exec sleep 1000 <> " + file_});
        if (!eventually([&] {
                const int end = open_end();
                close(end);
                return end >= 0;
            })) {
            throw std::runtime_error("nobody holds " + file_);
        }
    }
    void unplug() { holder_.reset(); }
    void send(int value) const {
        input_event event{};
        event.type = EV_KEY;
        event.code = BTN_0;
        event.value = value;
        const int end = open_end();
        written(::write(end, &event, sizeof event));
        close(end);
    }

private:
    [[nodiscard]] int open_end() const {
        return open(file_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    }
    std::string file_;
    std::unique_ptr<tests::Process> holder_;
};

}  // namespace palpate::tests
