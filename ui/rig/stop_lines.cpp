#include "ui/rig/stop_lines.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/realtime/realtime_rights.hpp"
#include "protocols/session/operator_desk.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

constexpr int kWaitMs =
    50;  ///< until the thread looks whether it is to end, and for a button that is gone

/// A shell's background job may neither read the terminal nor set it.
bool in_foreground() {
    return tcgetpgrp(STDIN_FILENO) == getpgrp();
}

/// What was typed before nobody meant. A pipe that never ends is given up.
void forget_typed() {
    std::array<char, 4096> bytes{};
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    for (int i = 0; i < 16 && poll(&input, 1, 0) > 0 && (input.revents & POLLIN) != 0; ++i) {
        if (read(STDIN_FILENO, bytes.data(), bytes.size()) <= 0) {
            return;
        }
    }
}

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

StopLines::StopLines(const std::string& database,
                     std::string label,
                     std::shared_ptr<StopButton> button,
                     Acts acts)
    : control_(database),
      label_(std::move(label)),
      button_(std::move(button)),
      acts_(std::move(acts)) {
    if (!control_.listens()) {
        warn(
            "as many programs listen there as can be called: palpate stop and the experimenter's "
            "page do not reach this one; its screen, its terminal and its button do");
    }
    struct stat input {};
    const bool there = acts_.types && fstat(STDIN_FILENO, &input) == 0;
    terminal_ = there && isatty(STDIN_FILENO) != 0 && in_foreground() &&
                tcgetattr(STDIN_FILENO, &before_) == 0;
    listens_ =
        terminal_ || (acts_.pipes && there && (S_ISFIFO(input.st_mode) || S_ISSOCK(input.st_mode)));
    if (listens_) {
        forget_typed();
    }
    if (terminal_) {
        termios with_escape = before_;
        with_escape.c_cc[VEOL] = static_cast<cc_t>(kEscapeByte);
        with_escape.c_iflag &= ~tcflag_t{IXON};  // Ctrl+S would hold the session with what it says
        tcsetattr(STDIN_FILENO, TCSANOW, &with_escape);
    }
    const engine::AllSignalsBlocked blocked;
    thread_ = std::thread([this] { live(); });
}

StopLines::~StopLines() {
    end_ = true;
    thread_.join();
    if (terminal_) {
        const engine::AllSignalsBlocked
            blocked;  // SIGTTOU would stop a job that went into the background
        tcsetattr(STDIN_FILENO, TCSANOW, &before_);
    }
}

void StopLines::live() noexcept {
    while (!end_) {
        try {
            const bool types =
                listens_ && TypedAnswer::living == 0 && (!terminal_ || in_foreground());
            const auto reads = [](int descriptor) {
                return pollfd{.fd = descriptor, .events = POLLIN, .revents = 0};
            };
            std::vector lines{reads(types ? STDIN_FILENO : -1),
                              reads(button_ ? button_->descriptor() : -1)};
            control_.add_to(lines);
            static_cast<void>(poll(lines.data(), lines.size(), kWaitMs));
            if (lines[1].revents != 0) {
                look_at_button();
            }
            control_.hear([this](const std::string& line, const std::shared_ptr<Caller>& caller) {
                obey(line, caller);
            });
            if (lines[0].revents != 0 && TypedAnswer::living == 0) {
                look_at_terminal();
            }
            if (button_ && button_->descriptor() < 0) {
                await_button();
            }
        } catch (const std::exception&) {  // no memory for a sentence: the force went off before it
        }
    }
}

/// No force first, whatever else is in the line.
void StopLines::obey(const std::string& line, const std::shared_ptr<Caller>& caller) {
    const data::Json asked = object_in(line);
    if (!asked.contains("do")) {
        caller->answer(false, R"(a line is one JSON object, as {"do":"stop"}: nothing was done)");
    } else if (asked["do"] == "stop" && asked.contains("people") && !acts_.types) {
        caller->answer(false, "nobody feels this session: it is stopped by its file");
    } else if (asked["do"] == "stop") {
        acts_.stop(asked.contains("page") ? "experimenter's page" : "palpate stop");
        caller->answer_line(one_line(data::Json{
            {"ok", true}, {"text", label_}, {"proved", !acts_.doubts || !acts_.doubts()}}));
    } else if (caller->trusted() && acts_.obey) {
        if (!caller->gave_up()) {  // and may have done it in another way
            acts_.obey(line, caller);
        }
    } else {
        caller->answer(false, caller->trusted() ? "no session runs here: it can only be stopped"
                                                : "another user may only stop: nothing was done");
    }
}

/// A piece of a line stops nothing in a pipe, and in a terminal no piece comes.
void StopLines::look_at_terminal() {
    std::array<char, 4096> bytes{};
    const ssize_t got = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got > 0) {
        for (ssize_t i = 0; i < got; ++i) {
            const char byte = bytes[static_cast<std::size_t>(i)];
            if (byte == '\n' || (terminal_ && byte == kEscapeByte)) {
                acts_.stop(terminal_ ? "terminal" : "standard input");
                return;
            }
        }
    } else if ((got == 0 && !terminal_) || (got < 0 && errno != EINTR && errno != EAGAIN)) {
        listens_ = false;
    } else if (got == 0) {
        poll(nullptr, 0,
             kWaitMs);  // the end of a terminal's input is no end: Ctrl+D, or it hangs up
    }
}

void StopLines::look_at_button() {
    switch (button_->look()) {
        case StopButton::ButtonState::nothing:
            break;
        case StopButton::ButtonState::pressed:
            acts_.stop("stop button");
            break;
        case StopButton::ButtonState::gone:
            acts_.bar(protocols::kButtonGone);
            acts_.stop("stop button gone");
            return;
    }
    acts_.bar(button_->down() ? protocols::kButtonDown : nullptr);
}

void StopLines::await_button() {
    if (button_->reopen()) {
        acts_.bar(nullptr);
        say("The stop button is there again.\n");
    }
}

StopButton::StopButton(std::string file) : file_(std::move(file)) {
    const std::string wrong = open_it();
    refuse_if(!wrong.empty(), "--stop-button {}: {}", file_, wrong);
}

std::string StopButton::open_it() {
    button_ = Descriptor(open(file_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
    if (descriptor() < 0) {
        return fmt::format("{}: plug it in, or give yourself the right to read it",
                           std::strerror(errno));
    }
    down_ = 0;
    std::string wrong = take(descriptor());
    if (!wrong.empty()) {
        button_ = Descriptor();
    }
    return wrong;
}

StopButton::ButtonState StopButton::look() noexcept {
    ButtonState seen = ButtonState::nothing;
    std::array<input_event, 16> events{};
    for (;;) {
        const ssize_t got = read(descriptor(), events.data(), sizeof events);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
            return seen;
        }
        if (got <= 0 || static_cast<std::size_t>(got) % sizeof(input_event) != 0) {
            button_ = Descriptor();
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
