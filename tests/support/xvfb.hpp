#pragma once

#include <memory>
#include <string>

#include "tests/support/process.hpp"

namespace palpate::tests {

/// A private X server on a free display number, ended with this object.
class Xvfb {
public:
    /// @throws std::runtime_error if Xvfb is not installed or does not come up in 20 s
    Xvfb(int width, int height);

    /// ":N", for DISPLAY and XOpenDisplay.
    [[nodiscard]] const std::string& display() const { return display_; }

private:
    std::unique_ptr<Process> server_;
    std::string display_;
};

}  // namespace palpate::tests
