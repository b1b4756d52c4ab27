#include "tests/support/x_hand.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <X11/keysym.h>

namespace palpate::tests {

struct XHand::Connection {
    Display* display = nullptr;
};

XHand::XHand(const std::string& display) : x_(std::make_unique<Connection>()) {
    for (int attempt = 0; attempt < 200 && x_->display == nullptr; ++attempt) {
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
}

XHand::~XHand() {
    XCloseDisplay(x_->display);
}

XHand::Window XHand::wait_for_window(const std::string& title, double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
        ::Window root = 0;
        ::Window parent = 0;
        ::Window* children = nullptr;
        unsigned count = 0;
        XQueryTree(x_->display, DefaultRootWindow(x_->display), &root, &parent, &children, &count);
        for (unsigned i = 0; i < count; ++i) {
            char* name = nullptr;
            XWindowAttributes attributes{};
            const bool named = XFetchName(x_->display, children[i], &name) != 0 &&
                               name != nullptr && title == name;
            if (name != nullptr) {
                XFree(name);
            }
            if (named && XGetWindowAttributes(x_->display, children[i], &attributes) != 0 &&
                attributes.map_state == IsViewable) {
                const Window found{children[i], attributes.x, attributes.y, attributes.width,
                                   attributes.height};
                XFree(children);
                XSetInputFocus(x_->display, found.id, RevertToParent, CurrentTime);
                XSync(x_->display, False);
                return found;
            }
        }
        if (children != nullptr) {
            XFree(children);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    throw std::runtime_error("no window named " + title);
}

void XHand::move(int x, int y) {
    XTestFakeMotionEvent(x_->display, -1, x, y, CurrentTime);
    XFlush(x_->display);
}

void XHand::click() {
    XTestFakeButtonEvent(x_->display, 1, True, CurrentTime);
    XTestFakeButtonEvent(x_->display, 1, False, CurrentTime);
    XFlush(x_->display);
}

void XHand::key(const std::string& name) {
    const KeyCode code = XKeysymToKeycode(x_->display, XStringToKeysym(name.c_str()));
    XTestFakeKeyEvent(x_->display, code, True, CurrentTime);
    XTestFakeKeyEvent(x_->display, code, False, CurrentTime);
    XFlush(x_->display);
}

std::uint64_t XHand::pixels(const Window& window) {
    XImage* image = XGetImage(x_->display, window.id, 0, 0, static_cast<unsigned>(window.width),
                              static_cast<unsigned>(window.height), AllPlanes, ZPixmap);
    if (image == nullptr) {
        throw std::runtime_error("the window's pixels cannot be read");
    }
    std::uint64_t hash = 1469598103934665603ULL;  // FNV-1a
    const std::size_t bytes =
        static_cast<std::size_t>(image->bytes_per_line) * static_cast<std::size_t>(image->height);
    for (std::size_t i = 0; i < bytes; ++i) {
        hash = (hash ^ static_cast<unsigned char>(image->data[i])) * 1099511628211ULL;
    }
    XDestroyImage(image);
    return hash;
}

}  // namespace palpate::tests
