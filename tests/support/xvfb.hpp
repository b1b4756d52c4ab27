#pragma once

#include "tests/support/process.hpp"

namespace palpate::tests {

/// A private X server on a free display number, ended with this object.
class Xvfb {
public:
    /// @param second  of 1024 x 768, as ":N.1"
    /// @throws std::runtime_error if Xvfb is not installed or does not come up in 60 s
    Xvfb(int width, int height, bool second = false);
    Xvfb(const Xvfb&) = delete;
    Xvfb& operator=(const Xvfb&) = delete;
    ~Xvfb();

    /// ":N", for DISPLAY and XOpenDisplay.
    [[nodiscard]] const std::string& display() const { return display_; }
    /// The server, e.g. to be killed or stopped.
    [[nodiscard]] Process& server() { return *server_; }

private:
    std::unique_ptr<Process> server_;
    std::string display_;
};

}  // namespace palpate::tests
