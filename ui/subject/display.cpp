#include "ui/subject/display.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <SDL2/SDL_syswm.h>
#include <fmt/format.h>

#include "engine/base/clock.hpp"
#include "engine/base/shared_library.hpp"
#include "ui/sdl/sdl.hpp"

namespace palpate::ui {
namespace {

PALPATE_LATE(Sdl, SDL_GetWindowWMInfo);  // whose header brings in X11's

std::atomic<bool> lost{false};
std::atomic<bool> owes{false};  ///< a sign of life
bool lost_keyboard = false;

/// The variable's value; empty if it is not set.
std::string named_by(const char* variable) {
    const char* value = std::getenv(variable);
    return value == nullptr ? "" : value;
}

FoundDisplay broken(const std::string& names) {
    return {FoundDisplay::State::broken,
            fmt::format("{}, and no display can be opened there ({}): name one that a person sees, "
                        "or give --headless to go without",
                        names, SDL_GetError())};
}

/// ":0.1": a screen of its own, and not the first one.
bool names_screen(const std::string& display) {
    const std::size_t point = display.find('.', display.rfind(':') + 1);
    return point != std::string::npos && display.substr(point) != ".0";
}

std::vector<std::string> list_monitors() {
    std::vector<std::string> all;
    for (int i = 0; i < SDL_GetNumVideoDisplays(); ++i) {
        const char* name = SDL_GetDisplayName(i);
        SDL_Rect place{};
        SDL_GetDisplayBounds(i, &place);
        all.push_back(fmt::format("{}, {} x {} at ({}, {})", name == nullptr ? "no name" : name,
                                  place.w, place.h, place.x, place.y));
    }
    return all;
}

#if defined(SDL_VIDEO_DRIVER_X11)
constexpr std::int64_t kAskEveryNs = 20'000'000;

::Window watched = 0;
::Display* asked = nullptr;
Atom sign = None;  ///< the property of the window that is written to hear of it
std::int64_t asked_ns = 0;
decltype(&XChangeProperty) change_property = nullptr;
decltype(&XGetInputFocus) input_focus = nullptr;
bool grabbed = false;  ///< another program holds the keyboard, whoever has the focus

/// SDL tells nothing of grabs (a locked screen, menus, keys of the window manager): no key comes
/// from them either.
void on_focus(const XFocusChangeEvent& x_event) {
    if (x_event.detail == NotifyInferior || x_event.detail == NotifyPointer) {
        return;
    }
    grabbed =
        x_event.type == FocusOut ? x_event.mode == NotifyGrab : x_event.mode == NotifyWhileGrabbed;
    lost_keyboard = lost_keyboard || x_event.type == FocusOut;
}

int on_broken_connection(::Display* /*display*/) {
    lost = true;
    return 0;
}

/// Another program may destroy the window. System events are for nobody else: they go no further.
int on_event(void* /*nothing*/, SDL_Event* event) {
    if (event->type != SDL_SYSWMEVENT) {
        return 1;
    }
    const XEvent& x_event = event->syswm.msg->msg.x11.event;
    if (x_event.type == DestroyNotify && x_event.xdestroywindow.window == watched) {
        lost = true;
    }
    if ((x_event.type == FocusIn || x_event.type == FocusOut) && x_event.xfocus.window == watched) {
        on_focus(x_event.xfocus);
    }
    if (x_event.type == PropertyNotify && x_event.xproperty.window == watched &&
        x_event.xproperty.atom == sign) {
        owes = false;
    }
    return 0;
}

/// Xlib's own handler would call exit(1) here.
void go_on_without(::Display* /*display*/, void* /*nothing*/) {}

/// No protocol error is worth a session; one about the window says that it is gone.
int on_protocol_error(::Display* /*display*/, XErrorEvent* error) {
    const bool gone = error->error_code == BadWindow || error->error_code == BadDrawable;
    if (gone && error->resourceid == watched) {
        lost = true;
    }
    return 0;
}

/// SDL loads Xlib while it runs, so that nobody links it; neither does this.
void watch_x11(::Display* display) {
    const SharedLibrary xlib("libX11.so.6");
    decltype(&XSetIOErrorExitHandler) on_exit = xlib.find("XSetIOErrorExitHandler");
    decltype(&XSetIOErrorHandler) on_io_error = xlib.find("XSetIOErrorHandler");
    decltype(&XSetErrorHandler) on_error = xlib.find("XSetErrorHandler");
    decltype(&XInternAtom) atom = xlib.find("XInternAtom");
    if (on_exit == nullptr || on_io_error == nullptr || on_error == nullptr || atom == nullptr) {
        return;
    }
    on_exit(display, go_on_without, nullptr);
    on_io_error(on_broken_connection);
    on_error(on_protocol_error);
    SDL_SetEventFilter(on_event, nullptr);
    SDL_EventState(SDL_SYSWMEVENT, SDL_ENABLE);
    input_focus = xlib.find("XGetInputFocus");
    change_property = xlib.find("XChangeProperty");
    asked = change_property != nullptr ? display : nullptr;
    sign = atom(display, "_PALPATE_SIGN_OF_LIFE", False);
    owes = false;
}
#endif

}  // namespace

bool is_real(const char* driver) noexcept {
    constexpr std::array<std::string_view, 4> kUnseen{"dummy", "offscreen", "disk", "evdev"};
    return driver != nullptr && std::ranges::find(kUnseen, driver) == kUnseen.end();
}

FoundDisplay find_display() {
    std::string names;
    for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"}) {
        if (const std::string value = named_by(variable); !value.empty()) {
            names += fmt::format("{}{} is {}", names.empty() ? "" : ", ", variable, value);
        }
    }
    if (names.empty()) {
        return {};
    }
    const bool opened = open_display();
    const FoundDisplay found =
        opened ? FoundDisplay{FoundDisplay::State::ready, {}, list_monitors()} : broken(names);
    SDL_Quit();
    return found;
}

bool open_display() {
    std::string drivers = named_by("DISPLAY").empty() ? "" : "x11";
    if (!named_by("WAYLAND_DISPLAY").empty()) {
        drivers += drivers.empty() ? "wayland" : ",wayland";
    }
    if (named_by("SDL_VIDEODRIVER").empty()) {
        unsetenv("SDL_VIDEODRIVER");  // set and empty, it would have SDL try every driver
    }
    if (names_screen(named_by("DISPLAY"))) {
        SDL_SetHint(SDL_HINT_VIDEO_X11_XRANDR, "0");  // with it SDL takes the first screen of all
    }
    SDL_SetHint(SDL_HINT_VIDEODRIVER, drivers.c_str());  // SDL_VIDEODRIVER goes before it
    // An X server that begins anew when its last client has left, as find_display() may have been,
    // takes nobody meanwhile.
    constexpr int kTries = 6;
    for (int attempt = 1; SDL_Init(SDL_INIT_VIDEO) != 0; ++attempt) {
        if (attempt == kTries) {
            return false;
        }
        SDL_Delay(60);
    }
    return true;
}

void watch_display([[maybe_unused]] SDL_Window* window) {
#if defined(SDL_VIDEO_DRIVER_X11)
    SDL_SysWMinfo info;
    SDL_VERSION(&info.version);
    if (SDL_GetWindowWMInfo(window, &info) == SDL_TRUE && info.subsystem == SDL_SYSWM_X11) {
        watched = info.info.x11.window;
        watch_x11(info.info.x11.display);
    }
#endif
}

void ask_display() noexcept {
#if defined(SDL_VIDEO_DRIVER_X11)
    const std::int64_t now = monotonic_ns();
    if (asked != nullptr && !lost && !owes && now - asked_ns >= kAskEveryNs) {
        constexpr unsigned char kNothing = 0;
        owes = true;
        asked_ns = now;
        change_property(asked, watched, sign, sign, 8, PropModeReplace, &kNothing, 1);
    }
#endif
}

bool display_owes_answer() noexcept {
    return owes;
}

bool keyboard_is_elsewhere() noexcept {
#if defined(SDL_VIDEO_DRIVER_X11)
    if (asked != nullptr && input_focus != nullptr) {
        ::Window focus = None;
        int revert = 0;
        return lost || input_focus(asked, &focus, &revert) == 0 || focus != watched || grabbed;
    }
#endif
    return is_real(SDL_GetCurrentVideoDriver()) && SDL_GetKeyboardFocus() == nullptr;
}

bool keyboard_was_lost() noexcept {
    return std::exchange(lost_keyboard, false);
}

bool display_lost() noexcept {
    return lost;
}

}  // namespace palpate::ui
