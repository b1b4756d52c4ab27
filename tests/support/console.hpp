#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/support/browser.hpp"
#include "tests/support/shown_session.hpp"

namespace palpate::tests {

/// `palpate console` on a session, and a browser that has its address.
struct Console {
    explicit Console(const ShownSession& session)
        : program({palpate_program(), "console", session.file}) {
        REQUIRE(eventually([&] { return program.out().find("\nCtrl+C") != std::string::npos; }));
        browser = std::make_unique<Browser>(program.out());
    }
    /// Asks for the stream with the cookie.
    [[nodiscard]] std::unique_ptr<HttpLine> stream() const {
        auto line = std::make_unique<HttpLine>(browser->port);
        line->say("GET /stream HTTP/1.1\r\nHost: " + browser->host + "\r\n" + browser->cookie +
                  "\r\n");
        return line;
    }
    Process program;
    std::unique_ptr<Browser> browser;
};

}  // namespace palpate::tests
