#include "tests/support/xvfb.hpp"

#include <filesystem>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

namespace palpate::tests {

Xvfb::Xvfb(int width, int height) {
    // Displays are taken from the process id, so that tests side by side do not meet; -displayfd would
    // choose one by itself, but only tells it over a pipe that the child would have to inherit.
    for (int attempt = 0; attempt < 50; ++attempt) {
        const int number = 100 + (static_cast<int>(getpid()) * 7 + attempt) % 800;
        if (std::filesystem::exists(fmt::format("/tmp/.X11-unix/X{}", number))) {
            continue;
        }
        display_ = fmt::format(":{}", number);
        server_ = std::make_unique<Process>(std::vector<std::string>{
            "Xvfb", display_, "-screen", "0", fmt::format("{}x{}x24", width, height), "-nolisten",
            "tcp", "-noreset"});
        for (int wait = 0; wait < 2000 && server_->running(); ++wait) {
            if (std::filesystem::exists(fmt::format("/tmp/.X11-unix/X{}", number))) {
                return;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        if (server_->running()) {
            break;
        }
    }
    throw std::runtime_error("Xvfb did not come up; install the package xvfb");
}

}  // namespace palpate::tests
