#include "tests/support/window_session.hpp"

#include "tests/support/sql_first.hpp"

namespace palpate::tests {
namespace {

constexpr const char* kTitle = "palpate: ";

void sleep_a_little() {
    std::this_thread::sleep_for(std::chrono::milliseconds(15));
}

std::string shown_by(XHand& hand) {
    const XHand::Window window = hand.find_window(kTitle);
    return window.id == 0 ? "" : window.title.substr(std::string(kTitle).size());
}

/// A chord that came too late for a trouble is a pause.
bool in_trouble(const std::string& screen) {
    return screen == "trouble" || screen == "pause";
}

}  // namespace

Words shown_on(const std::string& display) {
    // Leaks of the desktop libraries behind SDL's x11 driver (dbus among them) are not ours to
    // judge.
    return {"DISPLAY=" + display, "SDL_VIDEODRIVER=x11", "WAYLAND_DISPLAY",
            "ASAN_OPTIONS=detect_leaks=0",
            "TSAN_OPTIONS=suppressions=" PALPATE_SOURCE_DIR "/tests/support/tsan.supp"};
}

void press_on(XHand& hand) {
    const XHand::Window window = hand.find_window(kTitle);
    const std::string screen = shown_by(hand);
    if (window.id == 0) {
        return pause(0.1);
    }
    hand.focus(window);
    const auto stays = [&] {  // for some time
        for (int i = 0; i < 25 && shown_by(hand) == screen; ++i) {
            sleep_a_little();
        }
        return shown_by(hand) == screen;
    };
    if (screen != "pause") {
        hand.key(screen == "question" ? "1" : "space");
    }
    if (screen == "pause" || (screen == "trouble" && stays())) {
        hand.chord("p");
    }
    static_cast<void>(stays());
}

void leave_trouble(XHand& hand) {
    const auto end =
        std::chrono::steady_clock::now() + std::chrono::duration<double>(WindowSession::kPatience);
    while (in_trouble(shown_by(hand)) && std::chrono::steady_clock::now() < end) {
        press_on(hand);
    }
}

WindowSession::WindowSession(const Words& arguments, const Words& environment, const Screen& screen)
    : screen_(screen.width, screen.height, screen.second),
      display_(screen_.display() + (screen.second ? ".1" : "")),
      hand_(display_),
      database_(*std::next(std::ranges::find(arguments, "--db"))),
      program_(command_of(arguments), joined(shown_on(display_), environment)) {}

template <class Seen>
void WindowSession::wait(const std::string& what, const Seen& seen) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPatience);
    while (!seen()) {
        const bool ended = !program_.running();
        if (ended && seen()) {
            return;
        }
        if (ended || std::chrono::steady_clock::now() > end) {
            const std::string now = ended ? "" : screen_name();
            throw std::runtime_error(
                fmt::format("waited for {}; {}\n{}{}", what,
                            ended ? "the program has ended" : "the screen is \"" + now + "\"",
                            program_.out(), program_.error()));
        }
        sleep_a_little();
    }
}

std::string WindowSession::screen_name() {
    return shown_by(hand_);
}

XHand::Window WindowSession::wait_for_screen(const std::string& name) {
    XHand::Window window;
    wait("the screen \"" + name + "\"", [&] {
        window = hand_.find_window(kTitle + name);
        if (window.id != 0 && window.id != focused_) {
            window = hand_.wait_for_window(kTitle, kPatience);
            focused_ = window.id;
        }
        return window.id != 0 && window.title == kTitle + name;
    });
    return window;
}

XHand::Window WindowSession::wait_past(const std::string& name) {
    XHand::Window window;
    wait("another screen than \"" + name + "\"", [&] {
        window = hand_.find_window(kTitle);
        return !program_.running() || (window.id != 0 && window.title != kTitle + name);
    });
    return window;
}

void WindowSession::press_at(const std::string& name, const std::string& key) {
    wait_for_screen(name);
    auto pressed = std::chrono::steady_clock::time_point{};
    wait("the end of the screen \"" + name + "\"", [&] {
        if (!program_.running() || screen_name() != name) {
            return true;
        }
        if (std::chrono::steady_clock::now() - pressed > std::chrono::milliseconds(400)) {
            hand_.focus(hand_.find_window(kTitle));
            hand_.key(key);
            pressed = std::chrono::steady_clock::now();
        }
        return false;
    });
}

void WindowSession::go_through(std::initializer_list<const char*> names) {
    for (const char* name : names) {
        press_at(name, "space");
    }
}

bool WindowSession::comes_to(const std::string& name) {
    std::string seen;
    wait("the screen \"" + name + "\" or a trouble", [&] {
        seen = screen_name();
        return seen == name || in_trouble(seen);
    });
    leave_trouble(hand_);
    return seen == name;
}

bool WindowSession::goes_on_until(const std::function<bool()>& there) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPatience);
    while (!there() && program_.running() && std::chrono::steady_clock::now() < end) {
        if (screen_name() == "explore") {
            pause(0.05);
        } else {
            press_on(hand_);
        }
    }
    return there();
}

std::string WindowSession::ask(const std::string& query) const {
    return std::filesystem::exists(database_) ? sql_now(database_, query) : "";
}

void WindowSession::wait_until(const std::string& query, const std::string& wanted) {
    std::string last;
    try {
        wait(query, [&] {
            last = ask(query);
            return last == wanted;
        });
    } catch (const std::runtime_error& e) {
        throw std::runtime_error(
            fmt::format("wanted {}, last was \"{}\": {}", wanted, last, e.what()));
    }
}

void WindowSession::wait_for_text(const std::string& text) {
    wait("the words \"" + text + "\"", [&] {
        return program_.out().find(text) != std::string::npos ||
               program_.error().find(text) != std::string::npos;
    });
}

PointerSession::PointerSession(const std::string& study, const Words& more, const Screen& screen)
    : WindowSession(run_words(write(file("p.toml"), study),
                              "P1",
                              file("d.sqlite"),
                              joined({"--device", "mouse", "--kind", "pilot"}, more)),
                    {},
                    screen) {}

}  // namespace palpate::tests
