#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace palpate::ui {

/// A button named for the rig, as a device of Linux's evdev (/dev/input/by-id/...), or a named pipe
/// into which another program writes such events. Any key of it stops. While this lives no other
/// program gets its presses (EVIOCGRAB); of a pipe nobody can promise that.
class StopButton {
public:
    /// What was seen since the last look.
    enum class ButtonState : std::uint8_t {
        nothing,
        pressed,  ///< now, or in between: also where the kernel says that it had to drop events
        gone,     ///< unplugged, or it cannot be read
    };

    /// @throws std::invalid_argument if it is not there, is no such device, is pressed, or belongs
    /// to another program
    explicit StopButton(std::string file);
    StopButton(const StopButton&) = delete;
    StopButton& operator=(const StopButton&) = delete;
    ~StopButton();

    /// To be polled for reading; -1: gone.
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Never waits. Of several, what matters most.
    [[nodiscard]] ButtonState look() noexcept;
    /// A key of it is held down.
    [[nodiscard]] bool down() const noexcept { return down_ > 0; }
    /// After gone: it is there again, and nobody presses it. Never waits.
    [[nodiscard]] bool reopen() noexcept;
    [[nodiscard]] const std::string& file() const noexcept { return file_; }

private:
    /// @return what is wrong; empty: it is open
    [[nodiscard]] std::string open_it();
    void close_it() noexcept;

    std::string file_;
    int descriptor_ = -1;
    int down_ = 0;  ///< keys that are
};

inline constexpr std::string_view kStopButtonWords =
    "A button that switches the force off, as a file of /dev/input/by-id; palpate alone gets its "
    "presses, and without it there is no force";

/// @param file  empty: the rig has none   @throws as StopButton
[[nodiscard]] inline std::shared_ptr<StopButton> named_button(const std::string& file) {
    return file.empty() ? nullptr : std::make_shared<StopButton>(file);
}

}  // namespace palpate::ui
