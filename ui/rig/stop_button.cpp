#include "ui/rig/stop_button.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate::ui {
namespace {

/// A writer is at the other end of a pipe: without one, whoever reads it finds its end.
bool has_writer(int pipe) {
    std::array<input_event, 16> earlier{};
    return read(pipe, earlier.data(), sizeof earlier) != 0;
}

/// @return what is wrong with it
std::string take(int device) {
    struct stat kind {};
    fstat(device, &kind);
    if (S_ISFIFO(kind.st_mode)) {
        return has_writer(device) ? "" : "nobody writes into this pipe";
    }
    std::array<std::uint8_t, KEY_MAX / 8 + 1> keys{};
    if (!S_ISCHR(kind.st_mode) || ioctl(device, EVIOCGBIT(EV_KEY, keys.size()), keys.data()) < 0 ||
        std::ranges::all_of(keys, [](std::uint8_t byte) { return byte == 0; })) {
        return "this is no button: name one of /dev/input/by-id";
    }
    if (ioctl(device, EVIOCGRAB, 1) != 0) {
        return "another program holds it: end that";
    }
    keys.fill(0);
    ioctl(device, EVIOCGKEY(keys.size()), keys.data());
    return std::ranges::all_of(keys, [](std::uint8_t byte) { return byte == 0; })
             ? ""
             : "it is pressed: release it";
}

}  // namespace

StopButton::StopButton(std::string file) : file_(std::move(file)) {
    if (const std::string wrong = open_it(); !wrong.empty()) {
        throw std::invalid_argument(fmt::format("--stop-button {}: {}", file_, wrong));
    }
}

StopButton::~StopButton() {
    close_it();
}

std::string StopButton::open_it() {
    descriptor_ = open(file_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (descriptor_ < 0) {
        return fmt::format("{}: plug it in, or give yourself the right to read it",
                           std::strerror(errno));
    }
    down_ = 0;
    std::string wrong = take(descriptor_);
    if (!wrong.empty()) {
        close_it();
    }
    return wrong;
}

void StopButton::close_it() noexcept {
    if (descriptor_ >= 0) {
        close(descriptor_);
        descriptor_ = -1;
    }
}

StopButton::ButtonState StopButton::look() noexcept {
    ButtonState seen = ButtonState::nothing;
    std::array<input_event, 16> events{};
    for (;;) {
        const ssize_t got = read(descriptor_, events.data(), sizeof events);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
            return seen;
        }
        if (got <= 0 || static_cast<std::size_t>(got) % sizeof(input_event) != 0) {
            close_it();
            return ButtonState::gone;
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(got) / sizeof(input_event); ++i) {
            const input_event& event = events[i];
            if (event.type == EV_KEY && event.value != 2) {  // 2: held on
                down_ = std::max(0, down_ + (event.value == 1 ? 1 : -1));
            }
            const bool dropped = event.type == EV_SYN && event.code == SYN_DROPPED;
            if (dropped || (event.type == EV_KEY && event.value == 1)) {
                seen = ButtonState::pressed;
            }
        }
    }
}

bool StopButton::reopen() noexcept {
    try {
        return open_it().empty();
    } catch (const std::exception&) {
        return false;
    }
}

}  // namespace palpate::ui
