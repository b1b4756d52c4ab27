#include "ui/subject/display.hpp"

#include <atomic>
#include <cstdlib>
#include <cstring>

#include <SDL.h>
#include <SDL_syswm.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include "engine/base/clock.hpp"

namespace palpate::ui {
namespace {

std::atomic<bool> lost{false};
std::atomic<bool> owes{false};  ///< a sign of life

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

#if defined(SDL_VIDEO_DRIVER_X11)
constexpr std::int64_t kAskEveryNs = 20'000'000;

::Window watched = 0;
::Display* asked = nullptr;
Atom sign = None;  ///< the property of the window that is written to hear of it
std::int64_t asked_ns = 0;
decltype(&XChangeProperty) change_property = nullptr;

int on_broken_connection(::Display* /*display*/) {
    lost = true;
    return 0;
}

/// Another program may destroy the window. System events are for nobody else: they go no further.
int on_event(void* /*nothing*/, SDL_Event* event) {
    if (event->type != SDL_SYSWMEVENT) {
        return 1;
    }
    const XEvent& told = event->syswm.msg->msg.x11.event;
    if (told.type == DestroyNotify && told.xdestroywindow.window == watched) {
        lost = true;
    }
    if (told.type == PropertyNotify && told.xproperty.window == watched &&
        told.xproperty.atom == sign) {
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

template <class Call>
Call find(void* library, const char* name) {
    return reinterpret_cast<Call>(dlsym(library, name));  // NOLINT: dlsym knows no types
}

/// SDL loads Xlib while it runs, so that nobody links it; neither does this.
void watch_x11(::Display* display) {
    void* xlib = dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);
    if (xlib == nullptr) {
        return;
    }
    const auto on_exit = find<decltype(&XSetIOErrorExitHandler)>(xlib, "XSetIOErrorExitHandler");
    const auto on_io_error = find<decltype(&XSetIOErrorHandler)>(xlib, "XSetIOErrorHandler");
    const auto on_error = find<decltype(&XSetErrorHandler)>(xlib, "XSetErrorHandler");
    if (on_exit != nullptr && on_io_error != nullptr && on_error != nullptr) {
        on_exit(display, go_on_without, nullptr);
        on_io_error(on_broken_connection);
        on_error(on_protocol_error);
        SDL_SetEventFilter(on_event, nullptr);
        SDL_EventState(SDL_SYSWMEVENT, SDL_ENABLE);
        const auto atom = find<decltype(&XInternAtom)>(xlib, "XInternAtom");
        change_property = find<decltype(&XChangeProperty)>(xlib, "XChangeProperty");
        asked = atom != nullptr && change_property != nullptr ? display : nullptr;
        sign = asked != nullptr ? atom(display, "_PALPATE_SIGN_OF_LIFE", False) : None;
        owes = false;
    }
    dlclose(xlib);
}
#endif

}  // namespace

bool is_real(const char* driver) noexcept {
    if (driver == nullptr) {
        return false;
    }
    for (const char* unseen : {"dummy", "offscreen", "disk", "evdev"}) {
        if (std::strcmp(driver, unseen) == 0) {
            return false;
        }
    }
    return true;
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
    const FoundDisplay found = opened ? FoundDisplay{FoundDisplay::State::ready} : broken(names);
    SDL_Quit();
    return found;
}

bool open_display() {
    std::string drivers = named_by("DISPLAY").empty() ? "" : "x11";
    if (!named_by("WAYLAND_DISPLAY").empty()) {
        drivers += drivers.empty() ? "wayland" : ",wayland";
    }
    SDL_SetHint(SDL_HINT_VIDEODRIVER, drivers.c_str());  // SDL_VIDEODRIVER goes before it
    // An X server that begins anew when its last client has left, as find_display() may have been, takes
    // nobody meanwhile.
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

bool display_lost() noexcept {
    return lost;
}

}  // namespace palpate::ui
