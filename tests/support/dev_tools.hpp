#pragma once

#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/stat.h>

#include "tests/support/child.hpp"
#include "tests/support/program.hpp"

namespace palpate::tests {

/// A page in Chromium without a window, asked and pressed by its DevTools protocol over two pipes.
class DevTools {
public:
    [[nodiscard]] static bool installed() {
        return tests::installed("Chromium", {"sh", "-c", "command -v chromium"});
    }
    explicit DevTools(const std::string& address)
        : to_(pipe("to")),
          from_(pipe("from")),
          chromium_({"sh", "-c",
                     "exec chromium --headless=new --no-sandbox --disable-gpu --no-first-run "
                     "--disable-background-networking --disable-component-update "
                     "--window-size=1200,1400 --remote-debugging-pipe --user-data-dir=" +
                         folder_.file("profile") + " 3<" + folder_.file("to") + " 4>" +
                         folder_.file("from")}) {
        const auto target = call("Target.createTarget", {{"url", address}})["targetId"];
        session_ = call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}})
                       .value("sessionId", "");
    }
    DevTools(const DevTools&) = delete;
    DevTools& operator=(const DevTools&) = delete;
    ~DevTools() {
        static_cast<void>(call("Browser.close", nlohmann::json::object()));
        static_cast<void>(chromium_.wait(std::chrono::seconds(10)));
        close(to_);
        close(from_);
    }

    /// What an expression comes to, as text.
    [[nodiscard]] std::string value(const std::string& script) {
        const auto said = call("Runtime.evaluate", {{"expression", "String(" + script + ")"}});
        return said.value("result", nlohmann::json::object()).value("value", "");
    }
    void run(const std::string& script) { static_cast<void>(value(script)); }
    [[nodiscard]] std::string text(const std::string& id) {
        return value("document.getElementById('" + id + "')?.textContent");
    }
    /// Waits until an element's text has this in it, or is this. @return it does
    [[nodiscard]] bool shows(const std::string& id, const std::string& part) {
        return eventually([&] { return text(id).find(part) != std::string::npos; });
    }
    [[nodiscard]] bool is(const std::string& id, const std::string& whole) {
        return eventually([&] { return text(id) == whole; });
    }
    /// With the mouse, where it is, once it may be pressed: a page that was not served for long has
    /// lost the session until it hears of it.
    void press(const std::string& id) {
        REQUIRE(eventually(
            [&] { return value("document.getElementById('" + id + "').ariaDisabled") != "true"; }));
        const auto at = nlohmann::json::parse(
            value("(e => { e.scrollIntoView({block: 'center', behavior: 'instant'}); const b = "
                  "e.getBoundingClientRect(); return '[' + (b.x + b.width / 2) + ',' + (b.y + "
                  "b.height / 2) + ']'; })(document.getElementById('" +
                  id + "'))"));
        for (const char* what : {"mousePressed", "mouseReleased"}) {
            call("Input.dispatchMouseEvent", {{"type", what},
                                              {"x", at[0]},
                                              {"y", at[1]},
                                              {"button", "left"},
                                              {"clickCount", 1}});
        }
    }
    /// As it looks on a screen so wide, in pixels.
    void looks(int width, bool dark) {
        call("Emulation.setDeviceMetricsOverride", {{"width", width},
                                                    {"height", width > 500 ? width / 2 : 844},
                                                    {"deviceScaleFactor", 1},
                                                    {"mobile", false}});
        call("Emulation.setEmulatedMedia",
             {{"features", nlohmann::json::array({{{"name", "prefers-color-scheme"},
                                                   {"value", dark ? "dark" : "light"}}})}});
    }
    void type(const std::string& text) { call("Input.insertText", {{"text", text}}); }

private:
    int pipe(const char* name) const {
        REQUIRE(mkfifo(folder_.file(name).c_str(), S_IRUSR | S_IWUSR) == 0);
        return ::open(folder_.file(name).c_str(), O_RDWR | O_CLOEXEC);
    }
    /// @return its result; empty: an error, or none within a minute
    nlohmann::json call(const std::string& method, const nlohmann::json& parameters) {
        nlohmann::json asked{{"id", ++id_}, {"method", method}, {"params", parameters}};
        if (!session_.empty() && method != "Browser.close") {
            asked["sessionId"] = session_;
        }
        const std::string line = asked.dump();
        if (::write(to_, line.c_str(), line.size() + 1) < 0) {
            return {};
        }
        pollfd one{.fd = from_, .events = POLLIN, .revents = 0};
        for (;;) {
            for (std::size_t end = 0; (end = heard_.find('\0')) != std::string::npos;) {
                const auto said = nlohmann::json::parse(heard_.substr(0, end), nullptr, false);
                heard_.erase(0, end + 1);
                if (said.value("id", 0) == id_) {
                    return said.value("result", nlohmann::json::object());
                }
            }
            std::string piece(65536, '\0');
            if (poll(&one, 1, 60'000) <= 0) {
                return nlohmann::json::object();
            }
            const ssize_t got = ::read(from_, piece.data(), piece.size());
            heard_.append(piece, 0, static_cast<std::size_t>(got > 0 ? got : 0));
        }
    }

    TemporaryFolder folder_;
    int to_;
    int from_;
    Process chromium_;
    int id_ = 0;
    std::string session_{};
    std::string heard_{};
};

}  // namespace palpate::tests
