#pragma once

#include "tests/support/browser.hpp"
#include "tests/support/shown_session.hpp"

namespace palpate::tests {

/// Whoever was started by a process, and is `palpate console`; 0: nobody.
[[nodiscard]] inline pid_t console_of(pid_t parent) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const std::string name = entry.path().filename().string();
        pid_t id = 0;
        if (std::from_chars(name.data(), name.data() + name.size(), id).ec != std::errc()) {
            continue;
        }
        const std::string stat = slurp(entry.path().string() + "/stat");
        const std::size_t end = stat.rfind(')');
        if (end != std::string::npos && stat.substr(end + 2, 1) != "Z" &&
            std::atoi(stat.c_str() + end + 4) == parent &&
            slurp(entry.path().string() + "/cmdline").find("console") != std::string::npos) {
            return id;
        }
    }
    return 0;
}

/// It ended, whether or not anybody asked how.
[[nodiscard]] inline bool has_ended(pid_t process) {
    return kill(process, 0) != 0 ||
           slurp("/proc/" + std::to_string(process) + "/stat").find(") Z ") != std::string::npos;
}

/// `palpate console` on a session, and a browser that has its address.
struct Console {
    explicit Console(const ShownSession& session)
        : program({palpate_program(), "console", session.file}) {
        REQUIRE(eventually([&] { return program.out().find("\nCtrl+C") != std::string::npos; }));
        browser = std::make_unique<Browser>(program.out());
    }
    /// Asks for the stream with the cookie.
    [[nodiscard]] std::unique_ptr<HttpLine> stream(const std::string& query = {}) const {
        auto line = std::make_unique<HttpLine>(browser->port);
        line->say("GET /stream" + query + " HTTP/1.1\r\nHost: " + browser->host + "\r\n" +
                  browser->cookie + "\r\n");
        return line;
    }
    Process program;
    std::unique_ptr<Browser> browser;
};

}  // namespace palpate::tests
