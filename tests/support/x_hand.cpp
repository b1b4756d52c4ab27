#include "tests/support/x_hand.hpp"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <X11/keysym.h>

namespace palpate::tests {
namespace {

/// Errors that the server sent since the last look, e.g. of a window that went away.
std::atomic<int> errors{0};

int note_error(Display* /*display*/, XErrorEvent* /*error*/) {
    ++errors;
    return 0;
}

/// Whether a window has the keyboard and stands still.
constexpr std::chrono::milliseconds kMoment{100};

}  // namespace

struct XHand::Connection {
    Display* display = nullptr;

    /// Whether all that was asked since errors were last forgotten was granted.
    [[nodiscard]] bool all_well() const {
        XSync(display, False);
        return errors.exchange(0) == 0;
    }
    void send(const std::string& name, bool down) const {
        const KeyCode code = name.starts_with('#')
                               ? static_cast<KeyCode>(std::stoi(name.substr(1)))
                               : XKeysymToKeycode(display, XStringToKeysym(name.c_str()));
        if (code == 0) {
            throw std::invalid_argument("no key " + name);
        }
        XTestFakeKeyEvent(display, code, down ? True : False, CurrentTime);
        XFlush(display);
    }
};

XHand::XHand(const std::string& display) : x_(std::make_unique<Connection>()) {
    XSetErrorHandler(note_error);
    for (int attempt = 0; attempt < 1000 && x_->display == nullptr; ++attempt) {
        x_->display = XOpenDisplay(display.c_str());
        if (x_->display == nullptr) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    }
    int event = 0;
    int error = 0;
    int major = 0;
    int minor = 0;
    if (x_->display == nullptr ||
        XTestQueryExtension(x_->display, &event, &error, &major, &minor) == 0) {
        throw std::runtime_error("no display " + display + " with XTest");
    }
    // The server may be killed by a test; what is sent to it afterwards goes nowhere. Xlib's own
    // first handler exits, and so does its second.
    XSetIOErrorHandler([](Display*) { return 0; });
    XSetIOErrorExitHandler(
        x_->display, [](Display*, void*) {}, nullptr);
}

XHand::~XHand() {
    XCloseDisplay(x_->display);
}

XHand::Window XHand::find_window(const std::string& title) {
    static_cast<void>(x_->all_well());
    ::Window root = 0;
    ::Window parent = 0;
    ::Window* children = nullptr;
    unsigned count = 0;
    XQueryTree(x_->display, DefaultRootWindow(x_->display), &root, &parent, &children, &count);
    Window found;
    for (unsigned i = 0; i < count && found.id == 0; ++i) {
        char* name = nullptr;
        XWindowAttributes at{};
        const bool named = XFetchName(x_->display, children[i], &name) != 0 && name != nullptr;
        if (named && std::string(name).starts_with(title) &&
            XGetWindowAttributes(x_->display, children[i], &at) != 0 &&
            at.map_state == IsViewable) {
            found = {children[i], at.x, at.y, at.width, at.height, name};
        }
        if (name != nullptr) {
            XFree(name);
        }
    }
    if (children != nullptr) {
        XFree(children);
    }
    return x_->all_well() ? found : Window{};
}

XHand::Window XHand::wait_for_window(const std::string& title, double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
        if (const Window found = find_window(title); found.id != 0) {
            XSetInputFocus(x_->display, found.id, RevertToParent, CurrentTime);
            const bool taken = x_->all_well();
            std::this_thread::sleep_for(kMoment);
            const Window later = find_window(title);
            if (taken && later.id == found.id) {
                return later;
            }
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    throw std::runtime_error("no window named " + title);
}

void XHand::focus(const Window& window) {
    if (window.id != 0) {
        XSetInputFocus(x_->display, window.id, RevertToParent, CurrentTime);
        static_cast<void>(x_->all_well());
    }
}

void XHand::take_keyboard_away() {
    const ::Window other =
        XCreateSimpleWindow(x_->display, DefaultRootWindow(x_->display), 0, 0, 80, 40, 0, 0, 0);
    XMapWindow(x_->display, other);
    XSync(x_->display, False);
    XSetInputFocus(x_->display, other, RevertToParent, CurrentTime);
    static_cast<void>(x_->all_well());
}

void XHand::ask_to_close(const Window& window) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = window.id;
    event.xclient.message_type = XInternAtom(x_->display, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] =
        static_cast<long>(XInternAtom(x_->display, "WM_DELETE_WINDOW", False));
    XSendEvent(x_->display, window.id, False, NoEventMask, &event);
    static_cast<void>(x_->all_well());
}

void XHand::hide(const Window& window) {
    XUnmapWindow(x_->display, window.id);
    static_cast<void>(x_->all_well());
}

void XHand::show(const Window& window) {
    XMapWindow(x_->display, window.id);
    static_cast<void>(x_->all_well());
}

void XHand::frame(const Window& window, long left, long right, long top, long bottom) {
    const std::array<long, 4> extents{left, right, top, bottom};
    XChangeProperty(x_->display, window.id, XInternAtom(x_->display, "_NET_FRAME_EXTENTS", False),
                    XA_CARDINAL, 32, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(extents.data()), 4);
    static_cast<void>(x_->all_well());
}

void XHand::move(int x, int y) {
    XTestFakeMotionEvent(x_->display, DefaultScreen(x_->display), x, y, CurrentTime);
    XFlush(x_->display);
}

std::pair<int, int> XHand::place() {
    ::Window root = 0;
    ::Window child = 0;
    int x = 0;
    int y = 0;
    int within_x = 0;
    int within_y = 0;
    unsigned keys = 0;
    XQueryPointer(x_->display, DefaultRootWindow(x_->display), &root, &child, &x, &y, &within_x,
                  &within_y, &keys);
    return {x, y};
}

void XHand::click() {
    XTestFakeButtonEvent(x_->display, 1, True, CurrentTime);
    XTestFakeButtonEvent(x_->display, 1, False, CurrentTime);
    XFlush(x_->display);
}

void XHand::press(const std::string& name) {
    x_->send(name, true);
}

void XHand::release(const std::string& name) {
    x_->send(name, false);
}

void XHand::key(const std::string& name) {
    press(name);
    release(name);
}

void XHand::chord(const std::string& name) {
    press("Control_L");
    press("Shift_L");
    key(name);
    release("Shift_L");
    release("Control_L");
}

std::uint64_t XHand::pixels(const Window& window, double from) {
    const ScreenImage shown = image(window);
    const std::string_view all{reinterpret_cast<const char*>(shown.pixels.data()),
                               shown.pixels.size() * sizeof(std::uint32_t)};
    const auto rows = static_cast<std::size_t>(from * shown.height);
    return all.empty() ? 0
                       : std::hash<std::string_view>{}(all.substr(
                             rows * static_cast<std::size_t>(shown.width) * sizeof(std::uint32_t)));
}

ScreenImage XHand::image(const Window& window) {
    static_cast<void>(x_->all_well());
    XImage* image = XGetImage(x_->display, window.id, 0, 0, static_cast<unsigned>(window.width),
                              static_cast<unsigned>(window.height), AllPlanes, ZPixmap);
    static_cast<void>(x_->all_well());
    if (image == nullptr) {
        return {};
    }
    ScreenImage shown{.width = image->width, .height = image->height};
    for (int y = 0; y < image->height; ++y) {
        for (int x = 0; x < image->width; ++x) {
            shown.pixels.push_back(static_cast<std::uint32_t>(XGetPixel(image, x, y)) & 0xffffffU);
        }
    }
    XDestroyImage(image);
    return shown;
}

}  // namespace palpate::tests
