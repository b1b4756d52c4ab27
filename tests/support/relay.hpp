#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include "engine/base/descriptor.hpp"

namespace palpate::tests {

/// A port in front of another: for the kernel no emulator stands behind it, as behind a board.
class Relay {
public:
    /// @param link  a symbolic link to the port   @param target  the other one
    Relay(std::string link, const std::string& target) : link_(std::move(link)) {
        ports_[0] = Descriptor(open(target.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
        ports_[1] = Descriptor(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
        const int master = ports_[1].get();
        std::array<char, 128> name{};
        if (ports_[0].get() < 0 || master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
            ptsname_r(master, name.data(), name.size()) != 0) {
            throw std::runtime_error("there is no port to relay");
        }
        slave_ = Descriptor(open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
        for (const int port : {ports_[0].get(), slave_.get()}) {
            termios raw{};
            tcgetattr(port, &raw);
            cfmakeraw(&raw);
            tcsetattr(port, TCSANOW, &raw);
        }
        std::filesystem::create_symlink(name.data(), link_);
        thread_ = std::thread([this] { live(); });
    }
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;
    ~Relay() {
        ends_.store(true);
        thread_.join();
        std::filesystem::remove(link_);
    }

private:
    void live() {
        while (!ends_.load()) {
            std::array<pollfd, 2> heard{{{.fd = ports_[0].get(), .events = POLLIN, .revents = 0},
                                         {.fd = ports_[1].get(), .events = POLLIN, .revents = 0}}};
            if (poll(heard.data(), heard.size(), 10) <= 0) {
                continue;
            }
            for (std::size_t i = 0; i < 2; ++i) {
                std::array<char, 4096> bytes{};
                const ssize_t got = read(ports_[i].get(), bytes.data(), bytes.size());
                if (got > 0 && ::write(ports_[1 - i].get(), bytes.data(),
                                       static_cast<std::size_t>(got)) != got) {
                    return;
                }
            }
        }
    }

    std::string link_;
    std::array<Descriptor, 2> ports_{Descriptor(), Descriptor()};
    Descriptor slave_{};  ///< held open, as an emulator does
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

}  // namespace palpate::tests
