#pragma once

#include <arpa/inet.h>
#include <grp.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/socket.h>

#include "engine/base/clock.hpp"
#include "data/csv/json_text.hpp"
#include "data/store/database.hpp"
#include "ui/live/live_segment.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/process.hpp"
#include "tests/support/test_text.hpp"

namespace palpate::tests {

/// One connection to a server on this machine.
class HttpLine {
public:
    explicit HttpLine(std::uint16_t port)
        : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(port);
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        open_ = connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
    }
    HttpLine(const HttpLine&) = delete;
    HttpLine& operator=(const HttpLine&) = delete;
    ~HttpLine() { close(socket_); }

    void say(std::string_view text) const {
        static_cast<void>(send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
    }
    /// What has come until `text` is in it, nothing more comes, or the seconds are over.
    const std::string& hear_until(std::string_view text, int seconds = 50) {
        const std::int64_t end = monotonic_ns() + seconds * 1000 * kMillisecond;
        std::string piece(65536, '\0');
        while (open_ && heard_.find(text) == std::string::npos && monotonic_ns() < end) {
            pollfd one{.fd = socket_, .events = POLLIN, .revents = 0};
            if (poll(&one, 1, 100) > 0) {
                const ssize_t got = recv(socket_, piece.data(), piece.size(), 0);
                open_ = got > 0;
                heard_.append(piece, 0, static_cast<std::size_t>(got > 0 ? got : 0));
            }
        }
        return heard_;
    }
    [[nodiscard]] const std::string& heard() const { return heard_; }
    void forget() { heard_.clear(); }

private:
    int socket_;
    bool open_ = false;
    std::string heard_;
};

/// Asks the page of a `palpate console` as a browser would, or as one should not.
class Browser {
public:
    /// @param said  by the program: its address with the token
    explicit Browser(const std::string& said) {
        const std::size_t at = said.find("http://127.0.0.1:") + 17;
        port = static_cast<std::uint16_t>(std::stoi(said.substr(at)));
        token = said.substr(said.find("?token=") + 7, 32);
        host = "127.0.0.1:" + std::to_string(port);
    }
    /// @return status line, head and body
    [[nodiscard]] std::string get(const std::string& path, const std::string& more = {}) const {
        return ask("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" + more);
    }
    [[nodiscard]] std::string act(const std::string& body, const std::string& more) const {
        return ask("POST /do HTTP/1.1\r\nHost: " + host +
                       "\r\nContent-Type: application/json\r\nContent-Length: " +
                       std::to_string(body.size()) + "\r\n" + more,
                   body);
    }
    /// As the page does it, once its token was traded.
    [[nodiscard]] std::string act(const std::string& body) const {
        return act(body, cookie + origin());
    }
    [[nodiscard]] std::string ask(const std::string& head, const std::string& body = {}) const {
        HttpLine line(port);
        line.say(head + "Connection: close\r\n\r\n" + body);
        return line.hear_until(std::string_view("\0\1", 2));
    }
    /// Trades the token. @return the head that shows it was
    std::string trade() {
        const std::string answer = get("/?token=" + token);
        const std::size_t at = answer.find("Set-Cookie: ") + 12;
        cookie = "Cookie: " + answer.substr(at, answer.find(';', at) - at) + "\r\n";
        return answer;
    }
    /// Asks for the stream with the cookie.
    [[nodiscard]] std::unique_ptr<HttpLine> stream(const std::string& query = {}) const {
        auto line = std::make_unique<HttpLine>(port);
        line->say("GET /stream" + query + " HTTP/1.1\r\nHost: " + host + "\r\n" + cookie + "\r\n");
        return line;
    }
    [[nodiscard]] std::string origin() const { return "Origin: http://" + host + "\r\n"; }

    std::uint16_t port = 0;
    std::string token;
    std::string host;
    std::string cookie;
};

/// Whether it holds for a user whom nobody knows; true where this one may not become another.
[[nodiscard]] inline bool holds_for_a_stranger(const std::function<bool()>& law) {
    if (geteuid() != 0) {
        WARN("only root can become another user");
        return true;
    }
    const pid_t child = fork();
    if (child == 0) {
        constexpr uid_t kNobody = 65534;
        _exit(setgroups(0, nullptr) == 0 && setresgid(kNobody, kNobody, kNobody) == 0 &&
                      setresuid(kNobody, kNobody, kNobody) == 0 && law()
                  ? 0
                  : 1);
    }
    int status = 1;
    waitpid(child, &status, 0);
    return status == 0;
}

/// How often: as the environment's `name` says, else `usual`.
[[nodiscard]] inline int times(const char* name, int usual) {
    const char* asked = std::getenv(name);
    return asked != nullptr ? std::stoi(asked) : usual;
}

/// Asks how many events of a kind there are.
[[nodiscard]] inline std::string events_of(const std::string& kind) {
    return "SELECT count(*) FROM event WHERE event_kind = '" + kind + "'";
}

/// `palpate run` without a window, slow enough to be looked at; the study is longer than any test.
/// kFourTrials is short.
class ShownSession {
public:
    /// @param speed  and what else is said to `run`
    explicit ShownSession(const std::string& protocol = "shape_friction",
                          const Words& speed = {"2"})
        : file(folder_.file("d.sqlite")), program(command(protocol, speed)) {
        REQUIRE(eventually([&] {
            auto all = ui::running_sessions(file);
            if (!all.empty()) {
                shown = std::move(all.front());
            }
            return shown.reader != nullptr;
        }));
    }
    [[nodiscard]] data::Json ask(const data::Json& line) const {
        return data::Json::parse(ui::ask_session(shown.name, line.dump()).line, nullptr, false);
    }
    /// Empty before it shows any.
    [[nodiscard]] data::Json state() const {
        const auto state = shown.reader->state();
        return state ? data::Json::parse(state->json, nullptr, false) : data::Json::object();
    }
    [[nodiscard]] bool comes_to(const std::string& phase) const {
        return eventually([&] { return state().value("phase", "") == phase; });
    }
    [[nodiscard]] std::string kept(const std::string& sql) const {
        data::Database database(file, data::Access::read);
        data::Statement row = database.prepare(sql);
        return row.step() ? row.text(0) : "nothing";
    }
    [[nodiscard]] bool keeps(const std::string& sql, const std::string& value) const {
        return eventually([&] { return kept(sql) == value; });
    }

private:
    [[nodiscard]] Words command(const std::string& protocol, const Words& more) const {
        return joined({palpate_program(), "run", protocol, "--participant", "P1", "--db", file,
                       "--headless", "--operator", "Ada", "--secret", kRunSecret, "--speed"},
                      more);
    }
    TemporaryFolder folder_;

public:
    std::string file;
    Process program;
    ui::RunningSession shown;
};

/// Whoever was started by a process, and is `palpate console`; 0: nobody.
[[nodiscard]] inline pid_t console_of(pid_t parent) {
    for (const pid_t child : children_of(parent)) {
        if (slurp(fmt::format("/proc/{}/cmdline", child)).find("console") != std::string::npos) {
            return child;
        }
    }
    return 0;
}

/// It ended, whether or not anybody asked how.
[[nodiscard]] inline bool has_ended(pid_t process) {
    return kill(process, 0) != 0 ||
           slurp("/proc/" + std::to_string(process) + "/stat").find(") Z ") != std::string::npos;
}

/// A browser with the cookie of a page, once its server says where it is.
[[nodiscard]] inline Browser browser_of(const Process& server) {
    REQUIRE(server.says("\nCtrl+C"));
    Browser browser(server.out());
    browser.trade();
    return browser;
}

/// `palpate console` on a session, and a browser that has its address.
struct Console {
    explicit Console(const ShownSession& session)
        : program({palpate_program(), "console", session.file}) {
        REQUIRE(program.says("\nCtrl+C"));
        browser = std::make_unique<Browser>(program.out());
    }
    [[nodiscard]] std::unique_ptr<HttpLine> stream(const std::string& query = {}) const {
        return browser->stream(query);
    }
    Process program;
    std::unique_ptr<Browser> browser;
};

}  // namespace palpate::tests
